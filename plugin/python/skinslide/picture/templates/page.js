
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const slider = document.getElementById("frame");
const shown = document.getElementById("number");
const play = document.getElementById("play");
const last = data.labels.length - 1;
let current = 0; // index of the frame that the slider is at
let due = null; // when the next frame is to come, while playing

/* ---- A patch: its pictures, its curves, its table. A sample is one of its own frames. ---- */

function readStrip(section, i) {
  const pictures = [...section.querySelectorAll(".picture")].map(readPicture);
  const charts = [...section.querySelectorAll(".chart")];
  const rows = section.querySelector("details tbody").rows;
  const strip = {
    positions: data.positions[i], // of its samples among all frames; none where it has but a default value
    held: section.querySelector(".held"),
    rows,
    pictures,
    charts: charts.map((chart) => readChart(chart, rows)),
  };
  for (const chart of strip.charts) listen(chart, strip);
  return strip;
}

/* The first picture is in the page; the others are text until their view is first looked at. */
function readPicture(figure) {
  const image = figure.querySelector("img");
  const first = image.src;
  let sources = null;
  return {
    figure,
    show(sample, moment) {
      sources ??= [first, ...JSON.parse(figure.querySelector("script").textContent)];
      if (image.src !== sources[sample]) image.src = sources[sample];
      image.alt = `${image.dataset.alt}, ${moment}`;
      figure.querySelector(".at").textContent = moment;
    },
  };
}

function readChart(figure, rows) {
  const lines = [...figure.querySelectorAll("polyline")].map((line) => line.points);
  const marks = figure.querySelectorAll("circle");
  const cursor = figure.querySelector(".cursor");
  const values = figure.querySelectorAll("dd");
  const columns = JSON.parse(figure.dataset.columns);
  return {
    figure,
    svg: figure.querySelector("svg"),
    points: lines[0],
    show(sample) {
      const { cells } = rows[sample];
      figure.querySelector(".at").textContent = cells[0].dataset.moment;
      for (const end of ["x1", "x2"]) cursor.setAttribute(end, lines[0][sample].x);
      lines.forEach((points, i) => {
        marks[i].setAttribute("cx", points[sample].x);
        marks[i].setAttribute("cy", points[sample].y);
        values[i].textContent = cells[columns[i]].textContent;
      });
    },
  };
}

/* The sample at a frame, else the last one before it, else the first. */
function sampleAt(strip, index) {
  return Math.max(strip.positions.findLastIndex((position) => position <= index), 0);
}

function showStrip(strip) {
  const sample = sampleAt(strip, current);
  const view = document.querySelector(".views :checked")?.value;
  const chosen = strip.pictures.find(({ figure }) => figure.dataset.view === view) ?? strip.pictures[0];
  for (const picture of strip.pictures) picture.figure.hidden = picture !== chosen;
  chosen?.show(sample, strip.rows[sample].cells[0].dataset.moment);
  for (const chart of strip.charts) if (!chart.figure.classList.contains("hovered")) chart.show(sample);
  const missing = strip.positions.length > 0 && strip.positions[sample] !== current;
  strip.held.textContent = missing ? `has no frame ${data.labels[current]}` : "";
  for (const row of strip.rows) row.classList.toggle("current", row === strip.rows[sample]);
}

/* ---- Over a curve, its values are those under the pointer; a click, or a drag, goes there. ---- */

function listen(chart, strip) {
  const nearest = (event) => {
    const x = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.svg.getScreenCTM().inverse()).x;
    const distances = Array.from(chart.points, (point) => Math.abs(point.x - x));
    return distances.indexOf(Math.min(...distances));
  };
  const look = (event) => {
    chart.figure.classList.add("hovered");
    chart.show(nearest(event));
    if (event.buttons & 1) go(strip.positions[nearest(event)] ?? current);
  };
  chart.svg.addEventListener("pointerdown", look);
  chart.svg.addEventListener("pointermove", look);
  chart.svg.addEventListener("pointerleave", () => {
    chart.figure.classList.remove("hovered");
    chart.show(sampleAt(strip, current));
  });
}

/* ---- The player ---- */

function go(index) {
  current = Math.min(Math.max(index, 0), last);
  slider.value = current;
  slider.setAttribute("aria-valuetext", `frame ${data.labels[current]}`);
  shown.textContent = data.labels[current];
  strips.forEach(showStrip);
}

/* A frame lasts until the next one's time, at most a second where there is a gap. */
function milliseconds(index) {
  const gap = index < last ? data.frames[index + 1] - data.frames[index] : 1;
  return 1000 * Math.min(gap / data.timeCodesPerSecond, 1);
}

function tick(now) {
  if (due === null) return;
  let next = current;
  for (due = Math.max(due, now - 1000); due <= now; due += milliseconds(next)) next = next < last ? next + 1 : 0;
  if (next !== current) go(next);
  requestAnimationFrame(tick);
}

function setPlaying(playing) {
  due = playing ? performance.now() + milliseconds(current) : null;
  play.setAttribute("aria-pressed", playing);
  if (playing) requestAnimationFrame(tick);
}

function pressed(event) {
  const { target, key } = event;
  if (event.ctrlKey || event.altKey || event.metaKey || last < 1) return;
  if (key === " " && !target.closest("button, summary, .views")) setPlaying(due === null);
  else if (key === "ArrowLeft" && !target.closest(".views, #frame")) go(current - 1);
  else if (key === "ArrowRight" && !target.closest(".views, #frame")) go(current + 1);
  else return;
  event.preventDefault();
}

/* Frames named in tables and headings become buttons that go there. */
function makeJump(place) {
  const button = document.createElement("button");
  button.type = "button";
  button.append(...place.childNodes);
  button.setAttribute("aria-label", `Go to frame ${button.textContent}`);
  button.addEventListener("click", () => go(Number(place.dataset.jump)));
  place.append(button);
}

const strips = [...document.querySelectorAll(".strip")].map(readStrip);
document.querySelector(".player").hidden = !document.querySelector(".player > :not([hidden])");
slider.addEventListener("input", () => go(Number(slider.value)));
play.addEventListener("click", () => setPlaying(due === null));
document.addEventListener("keydown", pressed);
document.querySelectorAll(".views input").forEach((view) => view.addEventListener("change", () => go(current)));
if (last > 0) document.querySelectorAll("[data-jump]").forEach(makeJump);
go(0);
