// The page of property files: their curves, and sliders for the operating condition.
import {
  BOTTOM, axes, disc, frameOf, onThemeChange, penOf, placeOf, readTheme, roomy, straight, stroke, theme, whenPrinted,
} from "./axes.js";
import {content} from "./content.js";
import {byId, element, showTip} from "./dom.js";
import {labelled, symbol, trimmed, written} from "./text.js";

const controls = Object.fromEntries(content.controls.map(control => [control.name, control]));
const tyres = content.tyres.map((tyre, i, all) => ({
  ...tyre, shown: true, number: i % 8,
  wide: 2 + 1.6 * (all.length - 1 - i) / Math.max(all.length - 1, 1),  // wider below, so that all remain visible
  off: MODELS.off(tyre.values), on: MODELS.on(tyre.values),
}));
const panels = content.panels.map(panel => ({...panel, figure: byId(panel.key), bounds: null}));
const now = {};  // the sliders, in SI
const LOADS = [0.5, 1.5], SQUEEZE = 0.3, STEPS = 160, ABOVE = 8;
const INSIDE = 0, UNTESTED = 1, OUTSIDE = 2;
const DASHES = [[], [7, 5], [1, 5]];  // by zone
let mode = "file", settled = true, pending = false;

// ---- numbers
const isOn = tyre => mode === "file" ? tyre.turn_slip : mode === "on";
const evaluate = (tyre, condition) => (isOn(tyre) ? tyre.on : tyre.off)(...content.order.map(name => condition[name]));
const shownIn = (name, x) => x / content.quantities[name].si;
const sweptOf = panel => panel.sweep || panel.x;

function zone(tyre, condition) {
  return Math.max(INSIDE, ...Object.keys(tyre.ranges).map(name => zoneOf(tyre, name, condition[name])));
}
function zoneOf(tyre, name, x) {
  const beyond = range => range !== null && (x < range[0] - slack(range) || x > range[1] + slack(range));
  const ranges = tyre.ranges[name];
  return beyond(ranges.written) ? OUTSIDE : beyond(ranges.tested) ? UNTESTED : INSIDE;
}
const slack = range => 1e-6 * Math.max(Math.abs(range[0]), Math.abs(range[1]));

// A curve: its points in the units of the page, and whether each is within the tested and the written range.
function curve(panel, tyre, fixed) {
  const {name, min, max, si} = controls[sweptOf(panel)];
  return Array.from({length: STEPS + 1}, (_, i) =>
    point(panel, tyre, {...fixed, [name]: (min + (max - min) * i / STEPS) * si}));
}
const isEstimated = (panel, tyre) => [panel.x, panel.y].some(name => tyre.estimated.includes(name));
function point(panel, tyre, condition) {
  const own = valueOf(panel, tyre, condition);
  if (!isDifference()) return own;
  const first = valueOf(panel, tyres[0], condition);
  return {...own, y: own.y - first.y, zone: Math.max(own.zone, first.zone)};
}
function valueOf(panel, tyre, condition) {
  const found = evaluate(tyre, condition), of = name => name in found ? found[name] : condition[name];
  return {
    x: shownIn(panel.x, of(panel.x)), y: panel.sign * shownIn(panel.y, of(panel.y)),
    zone: Math.max(zone(tyre, condition), isEstimated(panel, tyre) ? UNTESTED : INSIDE), condition,
  };
}
// Less the first tyre, over an input: a picture of two outputs has no common place to compare at.
const isDifference = () => byId("difference").checked;
function curves(panel, tyre) {
  const fine = condition => ({points: curve(panel, tyre, {...now, ...condition}), isFine: true, tyre});
  const fan = panel.fan.map(angle => angle * controls.alpha.si).filter(alpha => Math.abs(alpha - now.alpha) > 1e-9);
  const loads = byId("loads").checked && panel.x !== "Fz" && !panel.fan.length ? LOADS : [];
  return [
    ...fan.map(alpha => fine({alpha})), ...loads.map(share => fine({Fz: share * now.Fz})),
    {points: curve(panel, tyre, now), isFine: false, tyre},
  ];
}
const withUnit = (name, x) => `${trimmed(written(x))} ${content.quantities[name].unit}`.trim();

// ---- pictures
function limits(panel, lines) {
  const all = lines.flatMap(line => line.points).filter(p => Number.isFinite(p.x) && Number.isFinite(p.y));
  const reach = axis => roomy(reached(all.filter(p => p.zone < OUTSIDE).map(p => p[axis]), all.map(p => p[axis])));
  const range = controls[panel.x], box = {x: range ? [range.min, range.max] : reach("x"), y: reach("y")};
  const old = settled ? null : panel.bounds;  // they only grow while a slider moves
  const wider = axis => old ? [Math.min(box[axis][0], old[axis][0]), Math.max(box[axis][1], old[axis][1])] : box[axis];
  return panel.bounds = {x: wider("x"), y: wider("y")};
}
// Limits that hold zero, all points within the ranges, and points outside unless they would squeeze the others.
function reached(inside, every) {
  const whole = [Math.min(0, ...every), Math.max(0, ...every)];
  if (!inside.length) return whole;
  const low = Math.min(0, ...inside), high = Math.max(0, ...inside), room = SQUEEZE * (high - low);
  return [Math.max(whole[0], low - room), Math.min(whole[1], high + room)];
}
function render(panel) {
  panel.figure.hidden = isDifference() && !controls[panel.x];
  const shown = tyres.filter(tyre => tyre.shown), lines = shown.flatMap(tyre => curves(panel, tyre));
  panel.lines = lines.sort((a, b) => b.isFine - a.isFine);
  panel.dots = shown.map(tyre => [tyre, point(panel, tyre, now)]);
  panel.figure.classList.toggle("flat", panel.turn_slip && !shown.some(isOn));
  limits(panel, lines);
  paint(panel, null, []);
}
// Draws a picture, with what the pointer marks: a place across, and points of tyres.
function paint(panel, pointer, marked) {
  const canvas = panel.figure.querySelector("canvas"), {clientWidth: width, clientHeight: height} = canvas;
  if (!width) return;
  const {pen, ratio} = penOf(canvas, width, height);
  const place = panel.place = placeOf(panel.bounds, width, height, ratio, ABOVE);
  const upright = (x, colour, dash) => straight(pen, place.X(x), ABOVE, place.X(x), height - BOTTOM, colour, dash);
  axes(pen, place);
  if (controls[panel.x]) upright(shownIn(panel.x, now[panel.x]), theme.accent, [2, 3]);
  pen.save();
  pen.clip(frameOf(place));
  Object.assign(pen, {lineCap: "round", lineJoin: "round"});
  for (const {points, isFine, tyre} of panel.lines) {
    pen.globalAlpha = isFine ? .65 : 1;
    for (const [kind, piece] of pieces(points)) {
      stroke(pen, piece, place, theme.colours[tyre.number], isFine ? 1 : tyre.wide, DASHES[kind]);
    }
  }
  pen.globalAlpha = 1;
  if (pointer !== null) upright(pointer, theme.muted, []);
  for (const [tyre, {x, y}] of [...panel.dots, ...marked]) {
    if (Number.isFinite(y)) disc(pen, place.X(x), place.Y(y), 4, theme.colours[tyre.number]);
  }
  pen.restore();
}
// Pieces [zone, x0, y0, x1, ...] of a curve; a segment between two zones has the one further outside.
function* pieces(points) {
  let piece = [], kind = null, last = null;
  const whole = () => piece.length > 2;
  for (const p of points) {
    if (!Number.isFinite(p.x) || !Number.isFinite(p.y)) {
      if (whole()) yield [kind, piece];
      [piece, kind, last] = [[], null, null];
      continue;
    }
    if (kind === null || p.zone <= kind) piece.push(p.x, p.y);
    if (kind !== null && p.zone !== kind) {
      if (whole()) yield [kind, piece];
      piece = p.zone > kind ? [last.x, last.y, p.x, p.y] : [p.x, p.y];
    }
    [kind, last] = [p.zone, p];
  }
  if (whole()) yield [kind, piece];
}
function nearest({place: {X, Y}, lines, sweep}, event) {
  const far = p => Math.abs(X(p.x) - event.offsetX) + (sweep ? Math.abs(Y(p.y) - event.offsetY) : 0);
  const points = lines.filter(line => !line.isFine).flatMap(line => line.points).filter(p => Number.isFinite(p.y));
  return points.reduce((best, p) => best === null || far(p) < far(best) ? p : best, null);
}
function pointed(panel, event) {
  const found = nearest(panel, event), name = sweptOf(panel);
  if (!found) return;
  const x = found.condition[name], shown = tyres.filter(tyre => tyre.shown);
  const marked = shown.map(tyre => [tyre, point(panel, tyre, {...now, [name]: x})]);
  paint(panel, panel.sweep ? null : found.x, marked);
  const lines = marked.map(([tyre, p]) => {
    const label = element("span", "", tyre.name), across = panel.sweep ? `${withUnit(panel.x, p.x)}, ` : "";
    label.style.color = `var(--c${tyre.number})`;
    return [label, across + withUnit(panel.y, p.y)];
  });
  const isLeft = panel.place.X(found.x) < panel.place.width / 2;
  const condition = [symbol(content.quantities[name]), withUnit(name, shownIn(name, x))];
  showTip(panel.figure.querySelector(".tip"), [condition, ...lines], isLeft);
}
for (const panel of panels) {
  const canvas = panel.figure.querySelector("canvas");
  canvas.addEventListener("pointermove", event => pointed(panel, event));
  canvas.addEventListener("pointerleave", () => {
    panel.figure.querySelector(".tip").hidden = true;
    paint(panel, null, []);
  });
  canvas.addEventListener("click", event => {
    const found = nearest(panel, event), name = sweptOf(panel);
    if (found) set(name, shownIn(name, found.condition[name]));
  });
}

// ---- the table of tyres
const COLUMNS = ["Fx", "Fy", "Mx", "My", "Mz", "trail"];
for (const tyre of tyres) {
  const line = byId("legend").tBodies[0].insertRow(), label = element("label", ""), swatch = element("span", "swatch");
  const box = Object.assign(element("input", ""), {type: "checkbox", checked: true});
  swatch.style.background = `var(--c${tyre.number})`;
  label.append(box, swatch, element("span", "name", tyre.name));
  tyre.about = element("span", "about");
  line.insertCell().append(label, tyre.about);
  tyre.cells = COLUMNS.map(() => line.insertCell());
  tyre.cells.forEach(cell => cell.className = "n");
  box.addEventListener("change", () => {
    tyre.shown = box.checked;
    line.classList.toggle("hidden", !tyre.shown);
    update();
  });
}
labelled(byId("legend"));
function table() {
  for (const tyre of tyres) {
    const found = evaluate(tyre, now);
    COLUMNS.forEach((name, i) => { tyre.cells[i].textContent = written(shownIn(name, found[name]), 2); });
    const beyond = kind => Object.keys(tyre.ranges).filter(name => zoneOf(tyre, name, now[name]) === kind)
      .map(name => content.quantities[name].word).join(", ");
    const notes = [`turn slip ${isOn(tyre) ? "on" : "off"}`];
    if (isOn(tyre) && tyre.doubt) notes.push("its coefficients of turn slip are defaults or zero");
    if (tyre.estimated.length) notes.push("Fx estimated, not measured");
    if (beyond(OUTSIDE)) notes.push(`outside the file's range: ${beyond(OUTSIDE)}`);
    if (beyond(UNTESTED)) notes.push(`beyond the tested range: ${beyond(UNTESTED)}`);
    tyre.about.textContent = notes.join("; ");
    tyre.about.classList.toggle("beyond", notes.length > 1);
  }
}

// ---- sliders
function set(name, shown, final = true) {
  const control = controls[name];
  if (!Number.isFinite(shown)) return;
  now[name] = shown * control.si;
  byId(name).value = shown;
  byId(`${name}-exact`).value = Number(shown.toPrecision(6));
  update(final);
}
function update(final = true) {
  settled = final;
  if (pending) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; all(); });
}
function all() {
  readTheme();
  table();
  panels.forEach(render);
  const minus = isDifference() ? `; pictures show the difference from ${tyres[0].name}` : "";
  byId("grid").classList.toggle("difference", isDifference());
  byId("condition").textContent = content.controls.map(({name}) =>
    `${content.quantities[name].word} ${withUnit(name, shownIn(name, now[name]))}`).join(", ") + minus;
}
for (const {name} of content.controls) {
  byId(name).addEventListener("input", event => set(name, event.target.valueAsNumber, false));
  byId(name).addEventListener("change", () => update());
  byId(`${name}-exact`).addEventListener("change", event => set(name, event.target.valueAsNumber));
}
for (const choice of document.querySelectorAll("input[name=turn_slip]")) {
  choice.addEventListener("change", () => { mode = choice.value; update(); });
}
for (const id of ["loads", "difference"]) byId(id).addEventListener("change", () => update());
byId("reset").addEventListener("click", start);
function start() {
  mode = "file";
  document.querySelector("input[name=turn_slip][value=file]").checked = true;
  byId("loads").checked = byId("difference").checked = false;
  for (const control of content.controls) set(control.name, control.start);
}
const dashed = tyre => tyre.estimated.length || Object.values(tyre.ranges).some(range => range.tested);
byId("key-tested").hidden = !tyres.some(dashed);
if (matchMedia("(max-width: 820px)").matches) byId("controls").open = false;
addEventListener("resize", () => update());
onThemeChange(all);
whenPrinted(all);
start();

// For the console: mffit.evaluate(0, true, [Fz, alpha, gamma, kappa, phi_t, Vx, pressure]), in SI. And for tests.
const panelOf = key => panels.find(panel => panel.key === key);
window.mffit = {
  order: content.order,
  evaluate: (index, turnSlip, inputs) => (turnSlip ? tyres[index].on : tyres[index].off)(...inputs),
  curve: (key, index) => curve(panelOf(key), tyres[index], now),
  lines: key => panelOf(key).lines.map(line => [...pieces(line.points)]),
  place: key => panelOf(key).place,
  texts: key => panelOf(key).place.texts,
};
