// Tables of the class "sortable": a click on a heading sorts the rows by its column, a second one the other way.
import {element} from "./dom.js";

const numberIn = text => Number.parseFloat(text.replace("−", "-"));
function compared(a, b) {
  const difference = numberIn(a) - numberIn(b);
  return Number.isNaN(difference) ? a.localeCompare(b) : difference;
}
function sort(table, column, isDown) {
  const textOf = row => row.cells[column].textContent, rows = [...table.tBodies[0].rows];
  rows.sort((one, other) => (isDown ? -1 : 1) * compared(textOf(one), textOf(other)));
  table.tBodies[0].append(...rows);
}
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  for (const head of heads) {
    const button = element("button", "sort", head.textContent, {type: "button"});
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const isDown = head.ariaSort === "ascending";
      for (const other of heads) other.ariaSort = null;
      head.ariaSort = isDown ? "descending" : "ascending";
      sort(table, head.cellIndex, isDown);
    });
  }
}
