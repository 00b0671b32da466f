// Numbers: the points, what the model says of them, and the misfit. Nothing here touches the page.
import {compiled} from "./tyre.js";

// points that a slider moves at once, all follow when it stops; of more, only those that can be seen are drawn
export const MOST_MOVED = 2000;
const TYPES = {f4: Float32Array, u1: Uint8Array, i1: Int8Array, u2: Uint16Array, i2: Int16Array, i4: Int32Array};
export const state = {hidden: {}, ranges: {}, colour: "Fz", reading: "curve", bands: true, fit: ""};
export let project = null;
export let rows = [];  // coefficients by index, and by name below
export let coefficient = {};
export let channels = [];  // those that the page computes
export let columns = {};  // typed arrays by name, of every point
let known = {};  // by name, whether a column has numbers that differ
export let own = {};  // by channel: the model at the conditions of every point
let moved = {};  // where the model at the points is computed anew
let every = 1;  // while a slider moves, of each so-manieth point only
export let fitOwn = {};  // the same of the fit, before any slider moved
export let models, fitModels, beforeModels = null;
export let misfits = {}, fitMisfits = {};  // by channel, of the present values and of the fit; see misfit
export let left = new Uint8Array(0);  // 1 where a point is left out
export let visible = new Uint8Array(0);
export let trial = {};  // coefficients that differ from the fit
let computed = "";  // for which values the model was computed at the points, and a number for them
export let serial = 0;
export let version = 0;  // of all that decides where points and the curves of the fits are, and how they look

export const setTrial = values => { trial = values; };
export const changed = () => { version++; };
// What a window adds, which writes into tyre.toml.
export const hooks = {
  canUndo: () => false, undoEdit() {}, extendRow() {}, chosenActions: () => [], leaveOut() {},
  entryOf: name => project.hand[name] ?? null,
};

export const quantity = name => project.quantities[name];
export const shownIn = (name, x) => x / quantity(name).si;
export const facet = name => project.points.facets.find(one => one.name === name);

// n numbers by their places. A typed array's own "from" takes ten times as long.
export function floats(n, of) {
  const found = new Float64Array(n);
  for (let i = 0; i < n; i++) found[i] = of(i);
  return found;
}
// The columns of unpacked bytes: of each the lowest bytes of all numbers, then the next ones.
function unpacked(bytes, layout) {
  const found = {};
  let from = 0;
  for (const [name, type, n] of layout) {
    const size = TYPES[type].BYTES_PER_ELEMENT, whole = new Uint8Array(n * size);
    for (let k = 0; k < size; k++) for (let i = 0; i < n; i++) whole[i * size + k] = bytes[from++];
    found[name] = new TYPES[type](whole.buffer);
  }
  return found;
}
// Takes the data of the fit, or what another fit of the same points has instead, with the bytes of its columns.
export function take(data, bytes, over = null) {
  project = data;
  rows = data.coefficients;
  coefficient = Object.fromEntries(rows.map(row => [row.name, row]));
  channels = data.channels.map(channel => channel.name);
  const points = data.points, n = points.count;
  columns = {count: n, shift: {}, read: {}, u: {}, of: {}, unused: {}, band: {}, missed: {}, half: {}};
  const set = found => {
    for (const [name, column] of Object.entries(found)) {
      const [kind, own] = name.split(".");
      if (own) columns[kind][own] = column; else columns[kind] = column;
    }
  };
  set(unpacked(bytes, points.layout));
  if (over) {  // bands are around the file as delivered
    columns.missed = {};
    set(unpacked(over, data.over));
  }
  for (const [name, shift] of Object.entries(columns.shift)) columns.read[name] = floats(n,
    i => columns[name][i] + shift[i]);
  columns.last = floats(n, i => columns.line[i] + columns.more[i]);
  for (const name of ["line", "last", "file"]) points[name] = columns[name];
  for (const one of points.facets) one.of = columns.of[one.name];
  columns.used = {};
  for (const name of channels) {
    columns.used[name] = new Uint8Array(n).fill(1, 0, points.fitted);
    for (const row of columns.unused[name]) columns.used[name][row] = 0;
  }
  known = Object.fromEntries(Object.keys(data.quantities).map(name => {
    const column = columns[name], first = column ? column.find(Number.isFinite) : undefined;
    return [name, first !== undefined && column.some(x => x !== first)];
  }));
  trial = Object.fromEntries(Object.entries(trial).filter(([name]) => name in data.values));
  fitModels = mounted(data.values);
  beforeModels = data.before ? mounted({...data.values, ...data.before.values}) : null;
  fitOwn = Object.fromEntries(channels.map(name => [name, predicted(fitModels, name, new Float64Array(n), 1)]));
  moved = {};
  computed = "";
  markLeftOut(data.exclude);
  recompute(false);
}
export const axisKnown = name => known[name];

// ---- the model
export const useOf = data => data.turn_slip ? "on" : "off";
// By mount: a flipped tyre has its conicity the other way.
function mounted(values) {
  const flipped = {...values}, use = useOf(project);
  for (const name of project.conicity) flipped[name] = -values[name];
  return {"1": compiled(use, values), "-1": compiled(use, flipped)};
}
function predicted(by_mount, name, found, step) {
  const [a, b, c, d, e, f, g] = project.order.map(input => columns[input]), mount = columns.mount;
  const normal = by_mount[1][name], flipped = by_mount[-1][name];
  for (let i = 0; i < columns.count; i += step) {
    found[i] = (mount[i] < 0 ? flipped : normal)(a[i], b[i], c[i], d[i], e[i], f[i], g[i])[name];
  }
  return found;
}
export const isMoved = name => channels.includes(name) &&
  project.channels.find(one => one.name === name).uses.some(used => used in trial);
// What the present values say of the points; while a slider moves, of some of them.
export function recompute(moves) {
  const wanted = JSON.stringify([moves, trial]);
  if (wanted === computed) return;
  computed = wanted;
  serial++;
  misfits = {};
  const differs = Object.keys(trial).length > 0;
  models = differs ? mounted({...project.values, ...trial}) : fitModels;
  every = moves ? Math.ceil(columns.count / MOST_MOVED) : 1;
  for (const name of channels) {
    own[name] = differs && isMoved(name)
      ? predicted(models, name, moved[name] ??= new Float64Array(columns.count), every) : fitOwn[name];
  }
}
export const stepOf = name => own[name] === fitOwn[name] ? 1 : every;
// Root mean square of what the model misses, in the channel's unit and in units of the noise that readings state.
export function misfit(channel, from = own) {
  const measured = columns[channel], u = columns.u[channel], used = columns.used[channel], model = from[channel];
  const step = from === own ? stepOf(channel) : 1;
  let sum = 0, n = 0, weighted = 0, m = 0;
  for (let i = 0; i < measured.length; i += step) {
    if (left[i]) continue;
    const gap = model[i] - measured[i];
    if (Number.isNaN(gap)) continue;
    sum += gap * gap;
    n++;
    if (u && used[i] && u[i] > 0) { weighted += (gap / u[i]) ** 2; m++; }
  }
  return {rmse: Math.sqrt(sum / n), over_noise: Math.sqrt(weighted / m), about: step > 1};
}

// ---- what is left out and what is shown
// Points that tyre.toml leaves out: [{file, lines}], lines such as "39-44, 60".
const rangesOf = entry => entry.lines.split(",").map(part => {
  const [first, last] = part.split("-").map(Number);
  return [first, last ?? first];
});
export function markLeftOut(entries) {
  const {line, file} = columns, end = line.reduce((most, one) => Math.max(most, one), 0) + 1, marked = {};
  for (const entry of entries) {
    const lines = marked[project.points.files.indexOf(entry.file)] ??= new Uint8Array(end);
    for (const [first, last] of rangesOf(entry)) lines.fill(1, first, last + 1);
  }
  left = new Uint8Array(columns.count);
  for (let i = 0; i < columns.count; i++) left[i] = marked[file[i]]?.[line[i]] ?? 0;
  misfits = {};
  fitMisfits = {};
  version++;
}
// Lines of points as [{file, lines}], in the notation of tyre.toml; ranges that touch are one.
export function lineRanges(members) {
  const {file, line, last} = columns, found = {};
  for (const i of Int32Array.from(members).sort((a, b) => file[a] - file[b] || line[a] - line[b])) {
    const ranges = found[file[i]] ??= [], before = ranges.at(-1);
    if (before && line[i] <= before[1] + 1) before[1] = Math.max(before[1], last[i]);
    else ranges.push([line[i], last[i]]);
  }
  const text = ([from, to]) => from === to ? `${from}` : `${from}-${to}`;
  return Object.entries(found).map(([k, ranges]) =>
    ({file: project.points.files[k], lines: ranges.map(text).join(", ")}));
}
export function whyLeftOut(i) {
  const file = project.points.files[columns.file[i]], line = columns.line[i];
  const found = project.exclude.find(entry => entry.file === file &&
    rangesOf(entry).some(([first, last]) => line >= first && line <= last));
  return found ? found.why || "" : "";
}
export function filter() {
  const n = columns.count;
  visible = new Uint8Array(n).fill(1);
  for (const one of project.points.facets) {
    const hidden = one.labels.map(text => (state.hidden[one.name] || []).includes(text));
    if (hidden.includes(true)) for (let i = 0; i < n; i++) if (hidden[one.of[i]]) visible[i] = 0;
  }
  for (const [name, [low, high]] of Object.entries(state.ranges)) {
    const column = columns[name];
    if (column) for (let i = 0; i < n; i++) {
      const x = shownIn(name, column[i]);
      if ((low !== null && x < low) || (high !== null && x > high)) visible[i] = 0;
    }
  }
  version++;
}

