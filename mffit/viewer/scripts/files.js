// The part of property files: their curves at the condition of the sliders, and the table of their forces there.
import {BOTTOM, TOP, disc, roomy, straight, stroke, theme} from "./axes.js";
import {content} from "./content.js";
import {byId, element, showTip} from "./dom.js";
import {
  addPanel, begin, draw, panels, recalled, remember, retheme, setDragging, update,
} from "./pictures.js";
import {csvText, labelled, named, symbol, trimmed, unitOf, written} from "./text.js";
import {compiled, curvePoints} from "./tyre.js";

const LOADS = [0.5, 1.5], SQUEEZE = 0.3, STEPS_OF_A_CURVE = 160;
const INSIDE = 0, UNTESTED = 1, OUTSIDE = 2;
const DASHES = [[], [7, 5], [1, 5]];  // by zone
const COLUMNS = ["Fx", "Fy", "Mx", "My", "Mz", "trail"];
const SWITCHES = ["loads", "difference"];
let tyres = [], controls = {}, drawnFor = "", pointer = null;  // what the pointer marks: {panel, dots, across}
const now = {};  // the condition of the sliders, in SI, by input

// ---- numbers
const use = () => document.querySelector("input[name=turn_slip]:checked").value;
const isOn = tyre => use() === "file" ? tyre.turn_slip : use() === "on";
const modelsOf = tyre => isOn(tyre) ? tyre.on : tyre.off;
const inUnit = (name, x) => x / content.quantities[name].si;
const withUnit = (name, x) =>
  `${name in controls ? trimmed(written(x)) : written(x)} ${content.quantities[name].unit}`.trim();
const isDifference = () => byId("difference").checked;  // from the first tyre, over an input
const shownTyres = () => tyres.filter(tyre => tyre.shown);

function zoneOf(tyre, name, x) {
  const slack = range => 1e-6 * Math.max(Math.abs(range[0]), Math.abs(range[1]));
  const beyond = range => range !== null && (x < range[0] - slack(range) || x > range[1] + slack(range));
  const ranges = tyre.ranges[name];
  return !ranges ? INSIDE : beyond(ranges.written) ? OUTSIDE : beyond(ranges.tested) ? UNTESTED : INSIDE;
}
// A line of a tyre in a picture, `changed` from the condition of the sliders: its points, what runs along them in SI,
// and their zones. Of one place if `x` is given.
function lineOf(panel, tyre, changed = {}, x = null) {
  const {order} = content, {min, max, si} = controls[panel.runs], condition = {...now, ...changed};
  const path = {fixed: order.map(name => condition[name]), place: order.indexOf(panel.runs), from: x ?? min * si,
    to: x ?? max * si}, steps = x === null ? STEPS_OF_A_CURVE : 1;
  const of = one => curvePoints(modelsOf(one), {...panel, path}, steps, order);
  const points = of(tyre), compared = isDifference() ? [tyre, tyres[0]] : [tyre];
  if (isDifference()) of(tyres[0]).forEach((y, k) => { if (k % 2) points[k] -= y; });
  const at = Array.from({length: steps + 1}, (_, k) => path.from + (path.to - path.from) * k / steps);
  const isGuessed = one => [panel.x, panel.y].some(name => one.estimated.includes(name));
  const zone = x => Math.max(...compared.flatMap(one => [isGuessed(one) ? UNTESTED : INSIDE,
    ...order.map(name => zoneOf(one, name, name === panel.runs ? x : condition[name]))]));
  return {tyre, condition, points, at, zones: at.map(zone), isFine: Object.keys(changed).length > 0};
}
function linesOf(panel) {
  const fan = panel.fan.map(angle => angle * controls.alpha.si).filter(alpha => Math.abs(alpha - now.alpha) > 1e-9);
  const loads = byId("loads").checked && panel.x !== "Fz" && !panel.fan.length ? LOADS : [];
  const changes = [...fan.map(alpha => ({alpha})), ...loads.map(share => ({Fz: share * now.Fz})), {}];
  return shownTyres().flatMap(tyre => changes.map(changed => lineOf(panel, tyre, changed)))
    .sort((a, b) => b.isFine - a.isFine);
}
// Ends of an axis that hold zero, all points within the ranges, and those outside unless they squeeze the others.
function reached(lines, axis) {
  const every = [], inside = [];
  for (const {points, zones} of lines) {
    for (const [k, zone] of zones.entries()) {
      const x = points[2 * k + axis];
      if (!Number.isFinite(x)) continue;
      every.push(x);
      if (zone < OUTSIDE) inside.push(x);
    }
  }
  const ends = of => [Math.min(0, ...of), Math.max(0, ...of)], whole = ends(every), [low, high] = ends(inside);
  const room = inside.length ? SQUEEZE * (high - low) : Infinity;
  return roomy(Math.max(whole[0], low - room), Math.min(whole[1], high + room));
}
// Pieces [zone, x0, y0, x1, ...] of a line; a segment between two zones has the one further outside.
function* pieces({points, zones}) {
  for (let k = 0; k + 1 < zones.length;) {
    const first = k, zone = Math.max(zones[k], zones[k + 1]);
    while (k + 1 < zones.length && Math.max(zones[k], zones[k + 1]) === zone) k++;
    yield [zone, points.slice(2 * first, 2 * k + 2)];
  }
}

// ---- pictures
const filesPart = {
  compute() {
    const wanted = JSON.stringify(this.kept());
    if (wanted === drawnFor) return;
    drawnFor = wanted;
    pointer = null;
    tyres.forEach(fillRow);
    byId("panels").classList.toggle("difference", isDifference());
    for (const {canvas, x} of panels) canvas.closest("figure").hidden = isDifference() && !controls[x];
    byId("condition").textContent = content.controls.map(({name}) =>
      `${content.quantities[name].word} ${withUnit(name, inUnit(name, now[name]))}`).join(", ") +
      (isDifference() ? `; pictures show the difference from ${tyres[0].name}` : "");
  },
  scene(panel) {
    if (panel.drawnFor !== drawnFor) {
      const isFlat = panel.turn_slip && !shownTyres().some(isOn), range = controls[panel.x];
      panel.canvas.closest("figure").classList.toggle("flat", isFlat);
      panel.lines = linesOf(panel);
      panel.dots = shownTyres().map(tyre => lineOf(panel, tyre, {}, now[panel.runs]));
      panel.ends = {x: range ? [range.min, range.max] : reached(panel.lines, 0), y: reached(panel.lines, 1)};
      panel.drawnFor = drawnFor;
    }
    return {name: drawnFor, box: panel.ends};
  },
  still(pen, panel, place) {
    if (controls[panel.x]) uprightAt(pen, place, inUnit(panel.x, now[panel.x]), theme.accent, [2, 3]);
    Object.assign(pen, {lineCap: "round", lineJoin: "round"});
    for (const line of panel.lines) {
      pen.globalAlpha = line.isFine ? .65 : 1;
      for (const [zone, piece] of pieces(line)) {
        stroke(pen, piece, place, theme.colours[line.tyre.number], line.isFine ? 1 : line.tyre.wide, DASHES[zone]);
      }
    }
    pen.globalAlpha = 1;
  },
  moving(pen, panel, place) {
    const marked = pointer && pointer.panel === panel ? pointer : {dots: []};
    if (marked.across !== undefined) uprightAt(pen, place, marked.across, theme.muted, []);
    for (const {tyre, points: [x, y]} of [...panel.dots, ...marked.dots]) {
      if (Number.isFinite(y)) disc(pen, place.X(x), place.Y(y), 4, theme.colours[tyre.number]);
    }
  },
  frame(panel, figure, caption, keys) {
    const x = content.quantities[panel.x], y = content.quantities[panel.y], letter = symbol(y),
      minus = panel.sign < 0 ? "−" : "";
    letter.prepend(minus);
    figure.id = panel.key;
    caption.append(element("strong", "", panel.word), letter, unitOf(y), element("span", "idle", "needs turn slip"),
      ...keys);
    figure.append(element("p", "x", [`${x.word} `, symbol(x), unitOf(x)]));
    panel.canvas.ariaLabel = `${panel.word} over ${x.word}; the arrow keys move its slider, + and - zoom, 0 shows all`;
    panel.words = {x: named(x), get y() { return `${isDifference() ? "Δ " : ""}${minus}${named(y)}`; }};
  },
  hover(panel, at) {
    const found = at && nearestOf(panel, at), name = panel.runs;
    pointer = null;
    panel.tip.hidden = !found;
    if (found) {
      const dots = shownTyres().map(tyre => lineOf(panel, tyre, {}, found.at));
      pointer = {panel, dots, across: panel.sweep ? undefined : found.x};
      showTip(panel.tip, [[symbol(content.quantities[name]), withUnit(name, inUnit(name, found.at))],
        ...dots.map(({tyre, points: [x, y]}) => {
          const label = element("span", "", tyre.name), before = panel.sweep ? `${withUnit(panel.x, x)}, ` : "";
          label.style.color = `var(--c${tyre.number})`;
          return [label, before + withUnit(panel.y, y)];
        })], panel.place.X(found.x) < panel.place.width / 2);
    }
    draw(panel);
  },
  click(panel, at, event) {
    const found = event.detail < 2 && nearestOf(panel, at);
    if (found) set(panel.runs, inUnit(panel.runs, found.at));
  },
  key(panel, event) {
    const by = {ArrowLeft: -1, ArrowRight: 1}[event.key], {min, max, step} = controls[panel.runs];
    if (!by) return;
    event.preventDefault();
    set(panel.runs, Math.min(Math.max(inUnit(panel.runs, now[panel.runs]) + by * step, min), max));
  },
  csv(panel) {
    const {order, quantities} = content, runs = order.indexOf(panel.runs);
    const rows = panel.lines.flatMap(({tyre, points, at, condition}) => at.map((x, k) => [tyre.name,
      ...order.map((name, i) => inUnit(name, i === runs ? x : condition[name])), points[2 * k], points[2 * k + 1]]));
    return csvText([["tyre", ...order.map(name => named(quantities[name])), panel.words.x, panel.words.y], ...rows]);
  },
  kept() {
    return {now, use: use(), hidden: tyres.filter(tyre => !tyre.shown).map(tyre => tyre.name),
      on: SWITCHES.filter(id => byId(id).checked)};
  },
};
const uprightAt = (pen, {X, height}, x, colour, dash) =>
  straight(pen, X(x), TOP, X(x), height - BOTTOM, colour, dash);
// The point of a bold line that is nearest to a place; over an input, by the distance across.
function nearestOf({place: {X, Y}, lines, sweep}, [x, y]) {
  let best = null;
  for (const {points, at, isFine} of lines) {
    for (const [k, value] of isFine ? [] : at.entries()) {
      if (!Number.isFinite(points[2 * k + 1])) continue;
      const far = Math.abs(X(points[2 * k]) - x) + (sweep ? Math.abs(Y(points[2 * k + 1]) - y) : 0);
      if (!best || far < best.far) best = {far, at: value, x: points[2 * k]};
    }
  }
  return best;
}

// ---- the table of tyres
function rowOf(tyre) {
  const swatch = element("span", "swatch"), box = element("input", "", "", {type: "checkbox",
    onchange: () => { tyre.show(box.checked); settle(); }});
  swatch.style.background = `var(--c${tyre.number})`;
  tyre.about = element("span", "about");
  tyre.cells = COLUMNS.map(() => element("td", "n"));
  const row = element("tr", "", [element("td", "", [element("label", "", [box, swatch,
    element("span", "name", tyre.name)]), tyre.about]), ...tyre.cells]);
  tyre.show = isShown => {
    tyre.shown = box.checked = isShown;
    row.classList.toggle("hidden", !isShown);
  };
  return row;
}
function fillRow(tyre) {
  const inputs = content.order.map(name => now[name]), models = modelsOf(tyre);
  COLUMNS.forEach((name, i) => {
    tyre.cells[i].textContent = written(inUnit(name, models[name](...inputs)[name]), 2);
  });
  const beyond = zone => content.order.filter(name => zoneOf(tyre, name, now[name]) === zone)
    .map(name => content.quantities[name].word).join(", ");
  const notes = [`turn slip ${isOn(tyre) ? "on" : "off"}`];
  if (isOn(tyre) && tyre.doubt) notes.push("its coefficients of turn slip are defaults or zero");
  const guessed = tyre.estimated.map(name => content.quantities[name].word).join(", ");
  if (guessed) notes.push(`estimated, not measured: ${guessed}`);
  if (beyond(OUTSIDE)) notes.push(`outside the file's range: ${beyond(OUTSIDE)}`);
  if (beyond(UNTESTED)) notes.push(`beyond the tested range: ${beyond(UNTESTED)}`);
  tyre.about.textContent = notes.join("; ");
  tyre.about.classList.toggle("beyond", notes.length > 1);
}

// ---- sliders
function put(name, shown) {
  now[name] = shown * controls[name].si;
  byId(name).value = shown;
  byId(`${name}-exact`).value = Number(shown.toPrecision(6));
}
function set(name, shown, moves = false) {
  if (!Number.isFinite(shown)) return;
  put(name, shown);
  settle(moves);
}
function settle(moves = false) {
  setDragging(moves);
  if (!moves) remember();
  update();
}
// All as the page opens, or as the address kept it.
function start(kept) {
  const given = name => Array.isArray(kept[name]) ? kept[name] : [];
  for (const one of document.querySelectorAll("input[name=turn_slip]")) {
    one.checked = one.value === (["on", "off"].includes(kept.use) ? kept.use : "file");
  }
  for (const id of SWITCHES) byId(id).checked = given("on").includes(id);
  for (const tyre of tyres) tyre.show(!given("hidden").includes(tyre.name));
  for (const {name, start} of content.controls) {
    const x = kept.now?.[name];
    put(name, Number.isFinite(x) ? inUnit(name, x) : start);
  }
}
export function showFiles() {
  controls = Object.fromEntries(content.controls.map(control => [control.name, control]));
  tyres = content.tyres.map((tyre, i, all) => ({...tyre, number: i % 8,
    wide: 2 + 1.6 * (all.length - 1 - i) / Math.max(all.length - 1, 1),  // wider below, so that all remain visible
    off: compiled("off", tyre.values), on: compiled("on", tyre.values)}));
  byId("legend").tBodies[0].append(...tyres.map(rowOf));
  labelled(byId("legend"));
  window.mffit = filesApi;
  begin(filesPart);
  for (const panel of content.panels) addPanel({...panel, runs: panel.sweep || panel.x,
    sx: content.quantities[panel.x].si, sy: panel.sign * content.quantities[panel.y].si});
  for (const {name} of content.controls) {
    byId(name).addEventListener("input", event => set(name, event.target.valueAsNumber, true));
    byId(name).addEventListener("change", () => settle());
    byId(`${name}-exact`).addEventListener("change", event => set(name, event.target.valueAsNumber));
  }
  for (const one of document.querySelectorAll(`input[name=turn_slip], #${SWITCHES.join(", #")}`)) {
    one.addEventListener("change", () => settle());
  }
  byId("reset").addEventListener("click", () => { start({}); settle(); });
  const dashed = tyre => tyre.estimated.length || Object.values(tyre.ranges).some(range => range.tested);
  byId("key-tested").hidden = !tyres.some(dashed);
  if (matchMedia("(max-width: 820px)").matches && innerWidth) byId("controls").open = false;  // 0: not laid out yet
  start(recalled());
  retheme();
}

// For the console: mffit.evaluate(0, true, [Fz, alpha, gamma, kappa, phi_t, Vx, pressure]), in SI. And for tests.
const panelOf = key => panels.find(panel => panel.key === key);
const filesApi = {
  evaluate: (index, turnSlip, inputs) =>
    Object.assign({}, ...Object.values(tyres[index][turnSlip ? "on" : "off"]).map(model => model(...inputs))),
  curve(key, index) {
    const {points, zones} = lineOf(panelOf(key), tyres[index]);
    return zones.map((zone, k) => ({x: points[2 * k], y: points[2 * k + 1], zone}));
  },
  lines: key => panelOf(key).lines.map(line => [...pieces(line)]),
  place: key => panelOf(key).place,
  texts: key => panelOf(key).place.texts,
};
