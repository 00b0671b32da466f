// What all pages with curves share: numbers as text, symbols of quantities, tables on a telephone.
import {element} from "./dom.js";

const DIGITS = 4;
export function written(x, most = 6) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const places = Math.max(0, DIGITS - 1 - Math.floor(Math.log10(Math.abs(x))));
  return x.toFixed(Math.min(places, most)).replace("-", "−");
}
export const trimmed = text => text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text;
export function symbol(quantity) {
  const [letter, low] = quantity.symbol.split("_");
  return element("span", "symbol", low ? [letter, element("sub", "", low)] : letter);
}
export const named = ({word, unit}) => unit ? `${word} [${unit}]` : word;
export const unitOf = ({unit}) => element("span", "unit", unit ? ` [${unit}]` : "");
// Lines of texts and numbers as CSV; numbers with seven digits.
export function csvText(lines) {
  const textOf = cell => typeof cell === "number" ? String(Number(cell.toPrecision(7))) : String(cell);
  const quoted = text => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  return lines.map(line => line.map(cell => quoted(textOf(cell))).join()).join("\n") + "\n";
}
// On a telephone a row is a paragraph, in which every number has the heading of its column.
export function labelled(table) {
  const headings = [...table.querySelectorAll("thead th")].map(one => one.textContent.trim());
  for (const line of table.tBodies[0].rows) {
    headings.forEach((text, k) => { if (text && line.cells[k]) line.cells[k].dataset.label = text; });
  }
}
