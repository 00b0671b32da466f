// What a picture of points shows: curves of the model through points that share their settings, and the bands around
// them. Nothing here touches the page.
import {
  MOST_MOVED, axisKnown, channels, columns, facet, fitModels, fitOwn, floats, left, models, own, project, quantity,
  serial, state, stepOf, version, visible,
} from "./model.js";
import {csvText} from "./text.js";
import {along, curvePoints} from "./tyre.js";

export const RESIDUAL = "residual of ";
const STEPS = 48, FEWEST_STEPS = 12, STEPS_OF_A_PICTURE = 9000, NARROWEST = 0.08, KNOTS = 16;
let grouped = {}, swept = {};  // groups by the input over which they are, and what each sweep varies

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
  if (swept.columns === columns) return swept.names;
  const all = SWEPT.map(spread);
  swept = {columns, names: all[0].map((_, k) => {
    const most = Math.max(...all.map(of => of[k]));
    return most ? SWEPT[all.findIndex(of => of[k] === most)] : "";
  })};
  return swept.names;
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
  if (grouped.visible !== visible) grouped = {visible};
  if (grouped[x]) return grouped[x];
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
  return grouped[x] = wide;
}
function median(members, column) {
  const step = Math.ceil(members.length / MOST_MOVED);  // so many tell it
  const sorted = floats(Math.ceil(members.length / step), k => column[members[k * step]]).sort(),
    k = sorted.length >> 1;
  return sorted.length % 2 ? sorted[k] : (sorted[k - 1] + sorted[k]) / 2;
}
// A channel along the curve of a group, in SI; and the points of a curve.
const alongGroup = (by_mount, group, name) => along(by_mount[group.mount], group, name, project.order);
export const pointsOf = (by_mount, curve, steps = curve.steps) =>
  curvePoints(by_mount[curve.path.mount], curve, steps, project.order);
// The input that runs along a curve: that of the axis; slip or sideslip where both axes are forces, as in a friction
// ellipse.
function parameterOf(x, y) {
  if (project.order.includes(x)) return x;
  if (x === y || !channels.includes(x)) return null;
  return [x, y].includes("Fx") && axisKnown("kappa") ? "kappa" : axisKnown("alpha") ? "alpha" : null;
}
// By how much the fitted model differs between a point's conditions and its curve's; sliders do not move the points.
function toTheCurve(group, x, name) {
  const model = alongGroup(fitModels, group, name);
  const {members} = group, at = columns[x], there = fitOwn[name];
  return (group.shift ??= {})[name] ??= floats(members.length, k => model(at[members[k]]) - there[members[k]]);
}
export function fixedCurve(by_mount, curve) {
  const name = `${curve.x} ${curve.y} ${by_mount === fitModels ? "fit" : "before"}`;
  return (curve.path.kept ??= {})[name] ??= pointsOf(by_mount, curve);
}
// Where a further run is expected around the curve of the fit, and the middle of that: [x, low, middle, high] along
// the curve.
export function bandOf(curve) {
  const {path, y} = curve;
  return (path.bands ??= {})[y] ??= bandPoints(curve);
}
function bandPoints({path: group, x, y, sx, sy}) {
  if (!columns.missed[y] || channels.includes(x)) return [];
  const inside = new Uint8Array(columns.count), knots = Array.from({length: KNOTS}, () => [0, 0, 0, 0]);
  for (const i of group.members) inside[i] = 1;
  columns.band.rows.forEach((row, k) => {
    if (!inside[row]) return;
    const at = columns[x][row],
      knot = knots[Math.min(KNOTS - 1, Math.floor((at - group.from) / (group.to - group.from) * KNOTS))];
    [1, at, columns.missed[y][k], columns.half[y][k]].forEach((number, j) => { knot[j] += number; });
  });
  const model = alongGroup(fitModels, group, y);
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
  return {px, py, curves: over.map(path => ({path, x: panel.x, y, sx, sy, steps})), residual, y, step: 1,
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
  const shown = panel.kept, {facets, files} = project.points;
  const ofPoint = i => facets.map(one => one.labels[one.of[i]] ?? "");
  const points = Array.from(inOrder(shown), i => [left[i] ? "left out" : "point", files[columns.file[i]],
    columns.line[i], ...ofPoint(i), shown.px[i], shown.py[i]]);
  const curves = shown.curves.flatMap(curve => {
    const found = pointsOf(models, curve), level = ofPoint(curve.path.members[0]),
      runs = project.order[curve.path.place];
    const of = facets.map((one, k) => one.is_run || one.inputs.includes(runs) ? "" : level[k]);
    return Array.from({length: curve.steps + 1}, (_, k) => ["curve", "", "", ...of, found[2 * k], found[2 * k + 1]]);
  });
  return csvText([["what", "file", "line", ...facets.map(one => one.word), label(panel.x), label(panel.y)], ...points,
    ...curves]);
}
