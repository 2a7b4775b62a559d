"use strict";
// Tables sort by a click on a heading: numbers by value, per cent as shares, text by its letters.
(() => {
  const value = (cell) => {
    const text = cell.textContent.trim();
    const plain = text.replace(/(\d)\s(?=\d{3}(?!\d))/g, "$1").replace("−", "-");
    const match = plain.match(/^-?\d+(\.\d+)?(e[+-]?\d+)?/i);
    if (!match) return text === "–" || text === "none" ? -Infinity : text;
    return /^\s*%/.test(plain.slice(match[0].length)) ? Number(match[0]) / 100 : Number(match[0]);
  };
  const compare = (a, b) =>
    typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b));
  for (const table of document.querySelectorAll("table.sortable")) {
    table.querySelectorAll("thead th").forEach((heading, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...heading.childNodes);
      heading.append(button);
      button.addEventListener("click", () => {
        const down = heading.getAttribute("aria-sort") === "ascending";
        for (const other of table.querySelectorAll("thead th")) other.removeAttribute("aria-sort");
        heading.setAttribute("aria-sort", down ? "descending" : "ascending");
        const body = table.tBodies[0];
        const rows = [...body.rows].map((row) => [value(row.cells[column]), row]);
        rows.sort((a, b) => (down ? -1 : 1) * compare(a[0], b[0]));
        body.append(...rows.map(([, row]) => row));
      });
    });
  }
  // On paper nothing can be opened.
  addEventListener("beforeprint", () => {
    for (const part of document.querySelectorAll("details")) part.open = true;
  });
})();
