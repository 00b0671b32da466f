// Numbers: the points, what the model says of them, the misfit, and the curves. Nothing here touches the page.
export const RESIDUAL = "residual of ";
const STEPS = 48, FEWEST_STEPS = 12, STEPS_OF_A_PICTURE = 9000, NARROWEST = 0.08, KNOTS = 16;
// points that a slider moves at once, all follow when it stops; of more, only those that can be seen are drawn
export const MOST_MOVED = 2000;
const TYPES = {f4: Float32Array, u1: Uint8Array, i1: Int8Array, u2: Uint16Array, i2: Int16Array, i4: Int32Array};
export const state = {panels: [], hidden: {}, ranges: {}, colour: "Fz", reading: "curve", bands: true, fit: ""};
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
let curveGroups = {}, swept = null;
let computed = "", serial = 0;  // for which values the model was computed at the points, and a number for them
export let version = 0;  // of all that decides where points and the curves of the fits are, and how they look

export const setTrial = values => { trial = values; };
export const changed = () => { version++; };
export let dragging = false;  // while a slider moves
export const setDragging = moves => { dragging = moves; };
// What a page adds: drawing after a change, moving a coefficient, and what a window writes into tyre.toml.
export const hooks = {
  update() {}, move() {}, canUndo: () => false, undoEdit() {}, extendRow() {}, chosenActions: () => [], leaveOut() {},
  entryOf: name => project.hand[name] ?? null,
};

export const quantity = name => project.quantities[name];
export const shownIn = (name, x) => x / quantity(name).si;
export const facet = name => project.points.facets.find(one => one.name === name);

// n numbers by their places. A typed array's own "from" takes ten times as long.
function floats(n, of) {
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
  swept = null;
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
  fitModels = compiled(data.values);
  beforeModels = data.before ? compiled({...data.values, ...data.before.values}) : null;
  fitOwn = Object.fromEntries(channels.map(name => [name, predicted(fitModels, name, new Float64Array(n), 1)]));
  moved = {};
  computed = "";
  markLeftOut(data.exclude);
  recompute(false);
}
export const axisKnown = name => known[name];

// ---- the model
function compiled(values) {
  const flipped = {...values};
  for (const name of project.conicity) flipped[name] = -values[name];
  const by_channel = of => Object.fromEntries(channels.map(name => [name, MODELS[name](of)]));
  return {"1": by_channel(values), "-1": by_channel(flipped)};
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
  models = differs ? compiled({...project.values, ...trial}) : fitModels;
  every = moves ? Math.ceil(columns.count / MOST_MOVED) : 1;
  for (const name of channels) {
    own[name] = differs && isMoved(name)
      ? predicted(models, name, moved[name] ??= new Float64Array(columns.count), every) : fitOwn[name];
  }
}
const stepOf = name => own[name] === fitOwn[name] ? 1 : every;
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
// Ranges in order, of which those that touch are one.
function joined(ranges) {
  const found = [];
  for (const [first, last] of ranges) {
    const before = found.at(-1);
    if (before && first <= before[1] + 1) before[1] = Math.max(before[1], last); else found.push([first, last]);
  }
  return found;
}
// Whether one of the ranges, in order and apart, holds a line; by halving, as there may be tens of thousands.
function holds(ranges, line) {
  let from = 0, to = ranges.length;
  while (from < to) {
    const middle = (from + to) >> 1;
    if (ranges[middle][1] < line) from = middle + 1; else to = middle;
  }
  return from < ranges.length && ranges[from][0] <= line;
}
export function markLeftOut(entries) {
  const {line, file} = columns, lists = project.points.files.map(() => []);
  left = new Uint8Array(columns.count);
  for (const entry of entries) {
    const list = lists[project.points.files.indexOf(entry.file)];
    if (list) for (const range of rangesOf(entry)) list.push(range);
  }
  const ranges = lists.map(list => joined(list.sort(([a], [b]) => a - b)));
  for (let i = 0; i < columns.count; i++) if (holds(ranges[file[i]], line[i])) left[i] = 1;
  misfits = {};
  fitMisfits = {};
  version++;
}
// Lines of points as [{file, lines}], in the notation of tyre.toml; ranges that touch are one.
export function lineRanges(members) {
  const {file, line, last} = columns, found = new Map();
  for (const i of Int32Array.from(members).sort((a, b) => file[a] - file[b] || line[a] - line[b])) {
    const name = project.points.files[file[i]];
    if (!found.has(name)) found.set(name, []);
    found.get(name).push([line[i], last[i]]);
  }
  const text = ([from, to]) => from === to ? `${from}` : `${from}-${to}`;
  return [...found].map(([name, ranges]) => ({file: name, lines: joined(ranges).map(text).join(", ")}));
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
  curveGroups = {};
  version++;
}

// ---- axes
const SWEPT = ["alpha", "gamma", "kappa"];
// By sweep, in how many parts of the range of all points an angle or slip lies; 0 where it is held.
function spread(name) {
  const X = columns[name], of = columns.of.sweep, many = facet("sweep").labels.length,
    ends = floats(2 * many, k => k % 2 ? -Infinity : Infinity);
  for (let i = 0; i < columns.count; i++) {
    const k = 2 * of[i];
    if (X[i] < ends[k]) ends[k] = X[i];
    if (X[i] > ends[k + 1]) ends[k + 1] = X[i];
  }
  const low = Math.min(...ends), least = NARROWEST * (Math.max(...ends) - low),
    parts = Array.from({length: many}, () => new Set());
  for (let i = 0; i < columns.count; i++) parts[of[i]].add(Math.floor((X[i] - low) / least));
  return parts.map((set, k) => ends[2 * k + 1] - ends[2 * k] > least && facet(name).labels.length > 1 ? set.size : 0);
}
// By sweep, what it varies most, of a grid the first; "" if it holds everything.
function sweptOver() {
  if (swept) return swept;
  const all = SWEPT.map(spread);
  return swept = all[0].map((_, k) => {
    const most = Math.max(...all.map(of => of[k]));
    return most ? SWEPT[all.findIndex(of => of[k] === most)] : "";
  });
}
// By sweep, whether it would be vertical lines over x: others vary x, and this one varies something else.
const upright = x => sweptOver().includes(x) ? sweptOver().map(name => name !== "" && name !== x) : [];
// What is drawn at first: each channel over what varies it, and then over what other sweeps vary; and the residuals.
export function defaultPanels() {
  const fitted = project.channels.filter(one => one.of_fit).map(one => one.name),
    others = project.points.measured.filter(name => !fitted.includes(name));
  const levels = name => facet(name).labels.length;
  const over = name => channels.length && !channels.includes(name) ? "Fz"
    : axisKnown("kappa") && (name === "Fx" || levels("kappa") > levels("alpha")) ? "kappa" : "alpha";
  const further = name =>
    SWEPT.filter(x => name !== "Fx" && over(name) !== "Fz" && over(name) !== x && sweptOver().includes(x));
  const all = names => [...names.map(y => ({x: over(y), y})), ...names.flatMap(y => further(y).map(x => ({x, y})))];
  return [...all(fitted), ...all(others), ...all(fitted).map(({x, y}) => ({x, y: RESIDUAL + y}))];
}

// ---- curves
// Points of one curve over x: the same levels of everything else; with the median of their conditions.
function groupsOver(x) {
  if (curveGroups[x]) return curveGroups[x];
  const facets = project.points.facets.filter(one => !one.is_run && !one.inputs.includes(x)), X = columns[x];
  const numbers = new Map(), of = new Int32Array(columns.count).fill(-1), counts = [];
  for (let i = 0; i < columns.count; i++) {
    if (!visible[i]) continue;
    let key = 0;
    for (const one of facets) key = key * (one.labels.length + 1) + one.of[i] + 1;
    let number = numbers.get(key);
    if (number === undefined) { numbers.set(key, number = counts.length); counts.push(0); }
    of[i] = number;
    counts[number]++;
  }
  const found = counts.map(count => ({members: new Int32Array(count), from: Infinity, to: -Infinity, n: 0}));
  for (let i = 0; i < columns.count; i++) {
    if (of[i] < 0) continue;
    const group = found[of[i]];
    group.members[group.n++] = i;
    if (X[i] < group.from) group.from = X[i];
    if (X[i] > group.to) group.to = X[i];
  }
  const low = Math.min(...found.map(group => group.from)), high = Math.max(...found.map(group => group.to));
  const wide = found.filter(group => group.to - group.from > NARROWEST * (high - low));
  for (const group of wide) {
    group.fixed = project.order.map(name => median(group.members, columns[name]));
    group.place = project.order.indexOf(x);
    group.mount = columns.mount[group.members[0]];
  }
  return curveGroups[x] = wide;
}
function median(members, column) {
  const step = Math.ceil(members.length / MOST_MOVED);  // so many tell it
  const sorted = floats(Math.ceil(members.length / step), k => column[members[k * step]]).sort(),
    k = sorted.length >> 1;
  return sorted.length % 2 ? sorted[k] : (sorted[k - 1] + sorted[k]) / 2;
}
// A channel along the curve of a group, in SI.
function along(by_mount, group, name) {
  const at = group.fixed.slice(), model = by_mount[group.mount][name];
  return x => {
    at[group.place] = x;
    return model(at[0], at[1], at[2], at[3], at[4], at[5], at[6])[name];
  };
}
// The input that runs along a curve: that of the axis; slip or sideslip where both axes are forces, as in a friction
// ellipse.
function parameterOf(x, y) {
  if (project.order.includes(x)) return x;
  if (x === y || !channels.includes(x)) return null;
  return [x, y].includes("Fx") && axisKnown("kappa") ? "kappa" : axisKnown("alpha") ? "alpha" : null;
}
// By how much the fitted model differs between a point's conditions and its curve's; sliders do not move the points.
function toTheCurve(group, x, name) {
  const model = along(fitModels, group, name);
  const {members} = group, at = columns[x], there = fitOwn[name];
  return (group.shift ??= {})[name] ??= floats(members.length, k => model(at[members[k]]) - there[members[k]]);
}
export function curvePoints(by_mount, curve, steps) {
  const {group, x, y} = curve, Y = along(by_mount, group, y),
    X = channels.includes(x) ? along(by_mount, group, x) : null;
  const found = new Float64Array(2 * steps + 2);
  for (let k = 0; k <= steps; k++) {
    const at = group.from + (group.to - group.from) * k / steps;
    found[2 * k] = (X ? X(at) : at) / curve.sx;
    found[2 * k + 1] = Y(at) / curve.sy;
  }
  return found;
}
export function fixedCurve(by_mount, curve) {
  const name = `${curve.x} ${curve.y} ${by_mount === fitModels ? "fit" : "before"}`;
  return (curve.group.kept ??= {})[name] ??= curvePoints(by_mount, curve, curve.steps);
}
// Where a further run is expected around the curve of the fit, and the middle of that: [x, low, middle, high] along
// the curve.
export function bandOf(curve) {
  const {group, y} = curve;
  return (group.bands ??= {})[y] ??= bandPoints(curve);
}
function bandPoints({group, x, y, sx, sy}) {
  if (!columns.missed[y] || channels.includes(x)) return [];
  const inside = new Uint8Array(columns.count), knots = Array.from({length: KNOTS}, () => [0, 0, 0, 0]);
  for (const i of group.members) inside[i] = 1;
  columns.band.rows.forEach((row, k) => {
    if (!inside[row]) return;
    const at = columns[x][row],
      knot = knots[Math.min(KNOTS - 1, Math.floor((at - group.from) / (group.to - group.from) * KNOTS))];
    [1, at, columns.missed[y][k], columns.half[y][k]].forEach((number, j) => { knot[j] += number; });
  });
  const model = along(fitModels, group, y);
  return knots.filter(knot => knot[0]).map(([n, at, missed, half]) => {
    const middle = model(at / n) + missed / n;
    return [at / n / sx, (middle - half / n) / sy, middle / sy, (middle + half / n) / sy];
  });
}

// What a picture shows of every point, in the units of the page, and its curves. Kept until anything but a slider
// changes.
export function placed(panel) {
  const name = [panel.x, panel.y, state.reading, version].join();
  if (!panel.kept || panel.kept.name !== name) panel.kept = {name, ...places(panel)};
  const shown = panel.kept;
  if (shown.residual && shown.serial !== serial) {
    const measured = columns[shown.y], model = own[shown.y], size = quantity(shown.y).si,
      step = shown.step = stepOf(shown.y);
    for (let i = 0; i < columns.count; i += step) shown.py[i] = (measured[i] - model[i]) / size;
    Object.assign(shown, {serial, order: null, extent: null});
  }
  return shown;
}
function places(panel) {
  const residual = panel.y.startsWith(RESIDUAL), y = residual ? panel.y.slice(RESIDUAL.length) : panel.y,
    n = columns.count;
  const source = name => (state.reading === "read" && columns.read[name]) || columns[name];
  const parameter = channels.includes(y) && !residual ? parameterOf(panel.x, y) : null, elsewhere = upright(panel.x),
    of = columns.of.sweep;
  const over = parameter ? groupsOver(parameter).filter(group => group.members.some(i => !elsewhere[of[i]])) : [];
  const sx = quantity(panel.x).si, sy = quantity(y).si, X = source(panel.x), Y = source(y);
  const px = floats(n, i => elsewhere[of[i]] ? NaN : X[i] / sx),
    py = residual ? new Float64Array(n) : floats(n, i => Y[i] / sy);
  const steps = Math.max(FEWEST_STEPS, Math.min(STEPS, Math.floor(STEPS_OF_A_PICTURE / over.length)));
  if (state.reading === "curve") {
    for (const group of over) {
      for (const [name, at, size] of [[panel.x, px, sx], [y, py, sy]]) {
        if (!channels.includes(name)) continue;
        const shift = toTheCurve(group, parameter, name), {members} = group;
        for (let k = 0; k < members.length; k++) at[members[k]] += shift[k] / size;
      }
    }
  }
  return {px, py, curves: over.map(group => ({group, x: panel.x, y, sx, sy, steps})), residual, y, step: 1,
    order: null};
}
// Ends of what points show: [x0, x1, y0, y1].
export function extent(shown) {
  const {px, py} = shown;
  let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
  for (let i = 0; i < px.length; i += shown.step) {
    const x = px[i], y = py[i];
    if (!visible[i] || Number.isNaN(x) || Number.isNaN(y)) continue;
    if (x < x0) x0 = x;
    if (x > x1) x1 = x;
    if (y < y0) y0 = y;
    if (y > y1) y1 = y;
  }
  return [x0, x1, y0, y1];
}
// Whether a curve passes through a box of the picture.
export function crosses(curve, [left, top, right, bottom], X, Y) {
  for (let k = 2; k < curve.length; k += 2) {
    const [x0, x1] = [X(curve[k - 2]), X(curve[k])], [y0, y1] = [Y(curve[k - 1]), Y(curve[k + 1])];
    if (Math.max(x0, x1) < left || Math.min(x0, x1) > right) continue;
    if (Math.max(y0, y1) > top && Math.min(y0, y1) < bottom) return true;
  }
  return false;
}
// The points of a picture in a rectangle of its units.
export function within(shown, x0, x1, y0, y1) {
  const {px, py} = shown, found = [];
  for (let i = 0; i < columns.count; i++) {
    if (visible[i] && px[i] >= x0 && px[i] <= x1 && py[i] >= y0 && py[i] <= y1) found.push(i);
  }
  return found;
}
export const inOrder = shown =>
  shown.order ??= Int32Array.from(within(shown, -Infinity, Infinity, -Infinity, Infinity))
  .sort((a, b) => shown.px[a] - shown.px[b] || shown.py[a] - shown.py[b]);
// Numbers of a picture as CSV: its points, then its curves.
export function csvOf(panel, label) {
  const shown = panel.kept, quoted = text => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  const lines = [["what", "file", "line", ...project.points.facets.map(one => one.word), label(panel.x),
    label(panel.y)]];
  for (const i of inOrder(shown)) {
    const of = project.points.facets.map(one => one.labels[one.of[i]] ?? "");
    lines.push([left[i] ? "left out" : "point", project.points.files[columns.file[i]], columns.line[i], ...of,
      shown.px[i], shown.py[i]]);
  }
  for (const curve of shown.curves) {
    const found = curvePoints(models, curve, curve.steps), first = curve.group.members[0];
    const of = project.points.facets.map(one => one.is_run || one.inputs.includes(parameterOf(curve.x, curve.y)) ? ""
      : one.labels[one.of[first]] ?? "");
    for (let k = 0; k < found.length; k += 2) lines.push(["curve", "", "", ...of, found[k], found[k + 1]]);
  }
  return lines.map(line => line.map(cell =>
    quoted(typeof cell === "number" ? String(Number(cell.toPrecision(7))) : String(cell))).join()).join("\n") + "\n";
}
