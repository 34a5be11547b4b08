
"use strict";
/* A heading becomes a button that sorts by its column: the largest numbers first, then the least; words by the alphabet. */
const body = document.querySelector(".sorted tbody");

function valueOf(row, column) {
  const text = row.cells[column]?.textContent.trim() ?? "";
  const number = Number(text.replace("\u2212", "-").replace(/[ %]/g, ""));
  return text === "" || Number.isNaN(number) ? text : number;
}

function compare(a, b) {
  if (typeof a === typeof b) return typeof a === "number" ? b - a : a.localeCompare(b);
  return typeof a === "number" ? -1 : 1;
}

document.querySelectorAll(".sorted thead th").forEach((heading, column) => {
  const button = document.createElement("button");
  button.type = "button";
  button.append(...heading.childNodes);
  button.addEventListener("click", () => {
    const again = heading.getAttribute("aria-sort") === "descending" ? -1 : 1;
    for (const other of heading.parentElement.cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", again > 0 ? "descending" : "ascending");
    const rows = [...body.rows].map((row) => [valueOf(row, column), row]);
    rows.sort(([a], [b]) => again * compare(a, b));
    body.append(...rows.map(([, row]) => row));
  });
  heading.append(button);
});
