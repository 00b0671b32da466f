// The list of coefficients: fields and sliders that act at once, and buttons that write tyre.toml.
import {byId, details, element, key, numberField, tell} from "./dom.js";
import {coefficient, hooks, project, rows, setTrial, trial} from "./model.js";
import {panels, remember, setDragging, update} from "./pictures.js";
import {channelOf} from "./points.js";
import {trimmed, written} from "./text.js";

const RESTS_AFTER = 250;  // [ms]
export const moves = [];  // what undo takes back
export const cells = {};
let dragFrom = null, resting = 0;
let listed = null;  // the project whose coefficients are listed
// Place of a coefficient: of the first shown channel that uses it, then of how many channels do; those of one channel
// come first.
function usedFirst() {
  const shown = [...new Set(panels.map(panel => channelOf(panel.y)))]
    .map(name => project.channels.find(one => one.name === name)).filter(Boolean);
  const place = name => {
    const first = shown.findIndex(one => one.uses.includes(name));
    return first < 0 ? Infinity : first + project.channels.filter(one => one.uses.includes(name)).length / 100;
  };
  return Object.fromEntries(rows.map(row => [row.name, place(row.name)]));
}
// Groups that the pictures use come first; others are closed at first.
export function listCoefficients() {
  const home = byId("coefficients"), place = usedFirst(),
    open = new Set([...home.querySelectorAll("details[open]")].map(one => one.dataset.key));
  const first = !home.children.length, nearest = group =>
    Math.min(...rows.filter(row => row.group === group && row.found).map(row => place[row.name]));
  const groups = [...new Set(rows.map(row => row.group))].map(group => [nearest(group), group])
    .sort(([one], [other]) => one === other ? 0 : one - other);
  const order = groups.map(([, group]) => group).join();
  if (home.dataset.order === order && listed === project) return;
  Object.assign(home.dataset, {order});
  listed = project;
  home.replaceChildren();
  for (const name in cells) delete cells[name];
  for (const [at, group] of groups) {
    const members = rows.filter(row => row.group === group), found = members.filter(row => row.found),
      rest = members.filter(row => !row.found);
    const box = details(home, group, `${group}`, first ? found.length > 0 && at < Infinity : open.has(group));
    for (const row of found) box.append(coefficientRow(row));
    if (rest.length) {
      const key = `${group}-rest`,
        inner = details(box, key, `${rest.length} that the points do not determine`, open.has(key));
      const fill = () => { if (inner.open && inner.children.length === 1) inner.append(...rest.map(coefficientRow)); };
      inner.addEventListener("toggle", fill);
      fill();
    }
  }
  find();
}
function coefficientRow(row) {
  const [low, high] = row.slider, to = (value, final = true) => move(row.name, value, final);
  const field = numberField({ariaLabel: row.name,
    onchange: () => { if (Number.isFinite(field.valueAsNumber)) to(field.valueAsNumber); }});
  const slider = element("input", "slider", "", {type: "range", min: low, max: high, step: "any",
    ariaLabel: `${row.name}, slider`, oninput: () => to(slider.valueAsNumber, false),
    onchange: () => to(slider.valueAsNumber), onkeydown: event => {
      const steps = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10}[event.key];
      if (!steps) return;
      event.preventDefault();
      to(Math.min(Math.max(slider.valueAsNumber + steps * (high - low) / 200, low), high));
    }});
  const reset = key("reset", "back to the fitted value", () => to(row.value)), keys = element("span", "keys", [reset]),
    tag = element("span", "tag"), about = element("div", "about"),
    u = element("span", "u", row.stderr ? `± ${row.stderr.toPrecision(2)}` : "");
  const line = element("div", "line", [element("span", "id", row.name), field, u, tag, keys]);
  const box = element("div", "coefficient", [line, slider, about],
    {title: `${row.about}${row.unit ? ` [${row.unit}]` : ""}`});
  box.dataset.name = row.name;
  cells[row.name] = {box, field, slider, tag, reset, about, keys};
  hooks.extendRow(row, keys, box);
  showRow(row);
  return box;
}
export function showRow(row) {
  const cell = cells[row.name];
  if (!cell) return;
  const moved = row.name in trial, value = moved ? trial[row.name] : row.value, entry = hooks.entryOf(row.name);
  cell.field.value = Number(value.toPrecision(5));
  cell.slider.value = value;
  cell.box.classList.toggle("moved", moved);
  cell.reset.hidden = !moved;
  const held = typeof entry === "number" || entry === "base";
  tell(cell.tag, entryText(entry) || (row.at_bound ? "at its bound" : row.status === "fitted" ? "" : row.status));
  cell.tag.hidden = !cell.tag.textContent;
  cell.tag.classList.toggle("held", held);
  const before = project.before && row.name in project.before.values ? project.before.values[row.name] : null;
  const parts = [row.about];
  if (before !== null &&
    Math.abs(before - row.value) > 1e-9 * Math.abs(row.value)) parts.push(`before ${trimmed(written(before))}`);
  if (moved) parts.push(`fit ${trimmed(written(row.value))}`);
  if (row.partner) parts.push(`goes with ${row.partner[0]} (correlation ${row.partner[1].toFixed(3)})`);
  tell(cell.about, parts.join("; "));
}
function entryText(entry) {
  if (entry === null || entry === undefined) return "";
  if (typeof entry === "number") return `held at ${Number(entry.toPrecision(6))}`;
  if (entry === "base") return "held at the base value";
  return Object.entries(entry).map(([name, x]) => `${name} ${x}`).join(", ");
}
export function find() {
  const wanted = byId("find").value.trim().toUpperCase();
  if (wanted) for (const inner of byId("coefficients").querySelectorAll("details")) inner.open = true;
  for (const name in cells) cells[name].box.hidden = wanted !== "" && !name.includes(wanted) &&
    !coefficient[name].about.toUpperCase().includes(wanted);
}

// ---- moves
export function move(name, value, final) {
  if (dragFrom === null) dragFrom = {...trial};
  if (value === coefficient[name].value) delete trial[name]; else trial[name] = value;
  setDragging(!final);
  clearTimeout(resting);
  // all points follow a slider that is held still
  if (!final) resting = setTimeout(() => { setDragging(false); update(); }, RESTS_AFTER);
  if (final) {
    moves.push({trial: dragFrom});
    dragFrom = null;
    remember();
  }
  showRow(coefficient[name]);
  update();
}
// Values by name in place of those of the fit; others stay as fitted.
export function tryOut(values) {
  moves.push({trial: {...trial}});
  setTrial(Object.fromEntries(Object.entries(project.values).filter(([name, x]) => name in values &&
    values[name] !== x).map(([name]) => [name, values[name]])));
  rows.forEach(showRow);
  remember();
  update();
}
// A change that is over, such as one of a file that another program has changed since, cannot be undone.
export const dropMoves = are => { moves.splice(0, moves.length, ...moves.filter(one => !are(one))); };
export function undo() {
  const last = moves.pop();
  if (!last || !last.trial) return hooks.undoEdit();
  const names = new Set([...Object.keys(trial), ...Object.keys(last.trial)]);
  setTrial(last.trial);
  for (const name of names) if (name in coefficient) showRow(coefficient[name]);
  remember();
  update();
}
