"use strict";
(() => {
  const words = new Intl.Collator(document.documentElement.lang, { numeric: true, sensitivity: "base" });
  const key = (row, column, numeric) => {
    const cell = row.cells[column];
    if (!numeric) return cell.textContent;
    const given = cell.dataset.v;
    return given === "inf" ? Infinity : given === "-inf" ? -Infinity : given === undefined ? NaN : Number(given);
  };
  // What is not known comes last, whichever way the rest goes; equal rows keep their order.
  const compare = (one, other, numeric, sign) => {
    if (!numeric) return sign * words.compare(one, other);
    if (Number.isNaN(one) || Number.isNaN(other)) return Number.isNaN(one) - Number.isNaN(other);
    return one === other ? 0 : one < other ? -sign : sign;
  };
  const sort = (table, head) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const numeric = "numeric" in head.dataset;
    const body = table.tBodies[0];
    const rows = Array.from(body.rows, (row) => [key(row, head.cellIndex, numeric), row]);
    rows.sort((one, other) => compare(one[0], other[0], numeric, down ? -1 : 1));
    body.append(...rows.map((pair) => pair[1]));
  };
  for (const head of document.querySelectorAll("thead th")) {
    const table = head.closest("table");
    if (table.tBodies[0].rows.length < 2) continue;
    // No <button>: Chromium leaves it out of the head that it repeats on every printed page.
    const handle = document.createElement("span");
    handle.tabIndex = 0;
    handle.setAttribute("role", "button");
    handle.append(...head.childNodes);
    head.append(handle);
    handle.addEventListener("click", () => sort(table, head));
    handle.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      sort(table, head);
    });
  }
  for (const field of document.querySelectorAll("input[data-filters]")) {
    const target = document.getElementById(field.dataset.filters);
    const count = field.closest("p").querySelector("output");
    const items = target.tBodies ? Array.from(target.tBodies[0].rows) : Array.from(target.children);
    let texts = null;
    field.addEventListener("input", () => {
      texts ??= items.map((item) => item.textContent.toLowerCase());
      const asked = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      items.forEach((item, place) => {
        item.hidden = !asked.every((word) => texts[place].includes(word));
        shown += !item.hidden;
      });
      count.textContent = asked.length ? `${shown} / ${items.length}` : "";
    });
  }
  for (const button of document.querySelectorAll("button[data-open]")) {
    button.addEventListener("click", () => {
      for (const part of document.querySelectorAll("details")) part.open = button.dataset.open === "all";
    });
  }
  // A link into a closed part opens it.
  const reveal = () => {
    const part = document.getElementById(location.hash.slice(1));
    if (!part) return;
    for (let outer = part.closest("details"); outer; outer = outer.parentElement.closest("details")) outer.open = true;
    part.hidden = false;
    part.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  if (location.hash) reveal();
})();
