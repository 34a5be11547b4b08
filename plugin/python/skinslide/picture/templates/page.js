
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const slider = document.getElementById("frame");
const shown = document.getElementById("number");
const play = document.getElementById("play");
const last = data.labels.length - 1;
const wipe = document.getElementById("wipe");
const place = document.getElementById("place");
const flicker = document.getElementById("flicker");
let current = data.start; // index of the frame that the slider is at
let flickering = null; // the timer that changes before and after
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
    film: [...section.querySelectorAll(".still")],
    pictures,
    charts: charts.map((chart) => readChart(chart, rows)),
    stretch: JSON.parse(charts[0].dataset.columns), // columns of the table that have it
  };
  for (const chart of strip.charts) listen(chart, strip);
  return strip;
}

/* The picture of the frame at which the page opens is in it; the others are text until their view is first looked at. Over the
 * picture, whose last column is seen, lies another whose first is. */
function readPicture(figure) {
  const image = figure.querySelector("img");
  const columns = JSON.parse(figure.dataset.columns);
  const own = image.src;
  const over = new Image();
  over.className = "over";
  over.alt = "";
  over.draggable = image.draggable = false;
  figure.querySelector(".pair").append(over);
  figure.style.setProperty("--columns", columns.length);
  const names = columns.map((name) => figure.querySelector("figcaption").appendChild(named(name)));
  let sources = null;
  let files = null;
  drag(figure.querySelector(".pair"));
  return {
    figure,
    /* At a frame that is left out, the last before it that is not; of a row a moment, and the stretch of each column. */
    show(sample, rows, stretch) {
      sources ??= JSON.parse(figure.querySelector(".sources").textContent).map((source) => source ?? own);
      files ??= JSON.parse(figure.querySelector(".files")?.textContent ?? "[]");
      const kept = Number.isInteger(sources[sample]) ? sources[sample] : sample;
      for (const each of [image, over]) if (each.src !== sources[kept]) each.src = sources[kept];
      if (files.length) figure.querySelector(".full").href = files[sample];
      const { cells } = rows[kept];
      image.alt = `${image.dataset.alt}, ${cells[0].dataset.moment}`;
      figure.querySelector(".at").textContent = cells[0].dataset.moment;
      const numbers = stretch.length === columns.length ? stretch.map((column) => cells[column].textContent) : [];
      names.forEach((name, i) => (name.lastChild.textContent = numbers[i] ?? ""));
      const asked = columns.indexOf(document.querySelector(".columns :checked")?.value);
      const shown = asked > 0 ? asked : columns.length - 1;
      figure.style.setProperty("--column", shown);
      names.forEach((name, i) => (name.hidden = inOnePlace() && i > 0 && i !== shown));
    },
  };
}

function named(column) {
  const name = document.createElement("span");
  name.className = "name";
  name.append(`${column} `, document.createElement("strong"));
  return name;
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
  const one = strip.pictures.find(({ figure }) => figure.dataset.view === view) ?? strip.pictures[0];
  for (const picture of strip.pictures) {
    picture.figure.hidden = view !== "" && picture !== one;
    if (!picture.figure.hidden) picture.show(sample, strip.rows, strip.stretch);
  }
  for (const chart of strip.charts) if (!chart.figure.classList.contains("hovered")) chart.show(sample);
  const missing = strip.positions.length > 0 && strip.positions[sample] !== current;
  strip.held.textContent = missing ? `has no frame ${data.labels[current]}` : "";
  for (const row of strip.rows) row.classList.toggle("current", row === strip.rows[sample]);
  for (const still of strip.film) still.classList.toggle("current", Number(still.dataset.jump) === current);
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

/* ---- Before and after in one place: wiped over each other, or by turns ---- */

const inOnePlace = () => place?.getAttribute("aria-pressed") === "true";

function setWipe(share) {
  wipe.value = share;
  document.documentElement.style.setProperty("--wipe", share / 100);
}

function setPlace(one) {
  place.setAttribute("aria-pressed", one);
  document.body.classList.toggle("once", one);
  wipe.disabled = flicker.disabled = !one;
  if (!one) setFlickering(false);
  strips.forEach(showStrip);
}

function setFlickering(on) {
  clearInterval(flickering);
  flickering = on ? setInterval(() => setWipe(Number(wipe.value) > 50 ? 0 : 100), 450) : null;
  flicker.setAttribute("aria-pressed", on);
}

/* Only before, or only after. */
function alone(before) {
  if (!inOnePlace()) setPlace(true);
  setFlickering(false);
  setWipe(before ? 100 : 0);
}

function drag(pair) {
  const follow = (event) => {
    if (!inOnePlace() || !(event.buttons & 1)) return;
    const box = pair.getBoundingClientRect();
    setFlickering(false);
    setWipe(Math.min(Math.max((100 * (event.clientX - box.left)) / box.width, 0), 100));
  };
  pair.addEventListener("pointerdown", follow);
  pair.addEventListener("pointermove", follow);
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
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (place && key === "w") setPlace(!inOnePlace());
  else if (place && (key === "a" || key === "b")) alone(key === "a");
  else if (place && key === "f") setFlickering(flickering === null && inOnePlace());
  else if (last < 1 || target === wipe) return;
  else if (key === " " && !target.closest("button, summary, .choice")) setPlaying(due === null);
  else if (key === "ArrowLeft" && !target.closest(".choice, #frame")) go(current - 1);
  else if (key === "ArrowRight" && !target.closest(".choice, #frame")) go(current + 1);
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
const player = document.querySelector(".player");
player.hidden = !player.querySelector(":scope > :not([hidden])");
/* What a link leads to comes to stand below the player, however many lines that takes. */
new ResizeObserver(() => (document.documentElement.style.scrollPaddingTop = `${player.offsetHeight}px`)).observe(player);
slider.addEventListener("input", () => go(Number(slider.value)));
play.addEventListener("click", () => setPlaying(due === null));
document.addEventListener("keydown", pressed);
document.querySelectorAll(".choice input").forEach((choice) => choice.addEventListener("change", () => go(current)));
if (place) {
  document.querySelector(".keys").hidden = false;
  place.addEventListener("click", () => setPlace(!inOnePlace()));
  flicker.addEventListener("click", () => setFlickering(flickering === null));
  wipe.addEventListener("input", () => setFlickering(false) ?? setWipe(Number(wipe.value)));
  setWipe(50);
  setPlace(true);
}
if (last > 0) document.querySelectorAll("[data-jump]").forEach(makeJump);
go(data.start);
