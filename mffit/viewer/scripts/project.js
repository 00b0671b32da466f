// The page: what happens when something is moved, clicked or typed. The address keeps what is seen.
import {onThemeChange, readTheme, whenPrinted} from "./axes.js";
import {find, listCoefficients, showRow} from "./coefficients.js";
import {byId, element, key, rowOf, showTip, tell} from "./dom.js";
import {
  RESIDUAL, axisKnown, channels, coefficient, columns, defaultPanels, dragging, facet, filter, fitMisfits, fitOwn,
  hooks, inOrder, left, misfit, misfits, own, project, quantity, recompute, rows, setDragging, setTrial, shownIn,
  state, take, trial, visible, whyLeftOut, within,
} from "./model.js";
import {
  MOST_LISTED, NEAREST_DRAG, ZOOM, chosen, draw, isChosen, label, look, nearest, palette, pan, pointed, recolour,
  saveNumbers, savePicture, setChosen, setPointed, zoom,
} from "./pictures.js";
import {labelled, symbol, trimmed, written} from "./text.js";

const RESTS_AFTER = 250;  // [ms]
export const moves = [];
let pending = false, dragFrom = null, resting = 0;

function move(name, value, final) {
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
export function update() {
  if (pending || !project) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; frame(); });
}
export function frame() {
  recompute(dragging);
  for (const panel of state.panels) draw(panel);
  showMisfit();
  byId("undo").disabled = !moves.length && !hooks.canUndo();
  byId("reset").disabled = !Object.keys(trial).length;
}
// A change that is over, such as one of a file that another program has changed since, cannot be undone.
export const dropMoves = are => { moves.splice(0, moves.length, ...moves.filter(one => !are(one))); };
function undo() {
  const last = moves.pop();
  if (!last || !last.trial) return hooks.undoEdit();
  const names = new Set([...Object.keys(trial), ...Object.keys(last.trial)]);
  setTrial(last.trial);
  for (const name of names) if (name in coefficient) showRow(coefficient[name]);
  remember();
  update();
}
function showMisfit() {
  const body = byId("misfit").tBodies[0], unit = name => quantity(name).unit;
  const noisy = channels.some(name => columns.u[name]);  // only readings that state their noise are compared with it
  byId("misfit-before").hidden = !project.before;
  byId("misfit-noise").hidden = !noisy;
  while (body.rows.length > channels.length) body.deleteRow(-1);
  channels.forEach((name, k) => {
    const line = body.rows[k] || body.insertRow(), now = misfits[name] ??= misfit(name),
      fit = fitMisfits[name] ??= misfit(name, fitOwn);
    if (!line.cells.length) for (let i = 0; i < 5; i++) line.insertCell().className = i ? "n" : "";
    if (line.dataset.name !== name) line.cells[0].replaceChildren(symbol(quantity(name)), ` [${unit(name)}]`);
    line.dataset.name = name;
    const before = project.before && name in project.before.rmse ? written(project.before.rmse[name]) : "";
    const ratio = Number.isFinite(now.over_noise) ? now.over_noise.toFixed(2) : "–";
    [`${now.about ? "≈ " : ""}${written(now.rmse)}`, written(fit.rmse), before,
      ratio].forEach((text, i) => tell(line.cells[i + 1], text));
    line.cells[3].hidden = !project.before;
    line.cells[4].hidden = !noisy;
    line.cells[4].title = "root mean square of (model - reading) / u of the readings that state their uncertainty u";
  });
}

// ---- points: pointing, choosing
function tip(panel, i) {
  panel.tip.hidden = i < 0;
  if (i < 0) return;
  const {px, py} = panel.kept;
  const lines = [[pointName(i), ""],
    ...[[panel.x, px], [panel.y, py]].map(([name, at]) => [label(name), trimmed(written(at[i]))])];
  showTip(panel.tip, lines, panel.place.X(px[i]) < panel.canvas.clientWidth / 2);
}
export function pointName(i) {
  const first = columns.line[i], last = columns.last[i];
  return `${project.points.files[columns.file[i]]}:${first}${last > first ? `-${last}` : ""}`;
}
function select(members) {
  setChosen(members);
  showChosen();
  update();
}
function choose(i, add) {
  if (i < 0) select(add ? chosen : []);
  else if (add) select(isChosen[i] ? chosen.filter(k => k !== i) : [...chosen, i]);
  else select([i]);
}
function chooseAll(members, add) {
  select(add ? chosen.concat([...members].filter(i => !isChosen[i])) : [...members]);
}
// What a drag in a picture does: a rectangle chooses points or becomes the view, or the picture is moved. Without a
// button of these pressed, that of a mouse chooses points, and a finger moves the page; two fingers zoom.
const TOOLS = ["select", "zoom", "move"];
const tool = () => TOOLS.find(name => byId(name).getAttribute("aria-pressed") === "true") || "";
function gestures(panel, plot) {
  const canvas = panel.canvas, frame = plot.appendChild(element("div", "rectangle")), touches = new Map();
  let from = null, to = null, just = false;
  const at = event => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const end = () => { from = to = null; frame.hidden = true; };
  end();
  // the page stays
  canvas.addEventListener("touchstart", event => { if (event.touches.length > 1) event.preventDefault(); },
    {passive: false});
  canvas.addEventListener("pointerdown", event => {
    just = false;
    if (event.pointerType === "touch") touches.set(event.pointerId, at(event));
    if (touches.size > 1) return end();
    if (event.button === 0 && (event.pointerType !== "touch" || tool())) from = at(event);
  });
  canvas.addEventListener("pointermove", event => {
    const now = at(event);
    if (touches.size === 2 && touches.has(event.pointerId)) {
      const [, other] = [...touches].find(([id]) => id !== event.pointerId), old = touches.get(event.pointerId);
      touches.set(event.pointerId, now);
      pan(panel, (now[0] - old[0]) / 2, (now[1] - old[1]) / 2);
      const apart = place => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), NEAREST_DRAG);
      return zoom(panel, apart(old) / apart(now), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    }
    if (!from) return;
    if (!to && Math.hypot(now[0] - from[0], now[1] - from[1]) < NEAREST_DRAG) return;
    if (!to) canvas.setPointerCapture(event.pointerId);
    if (tool() === "move") {
      const last = to || from;
      to = now;
      return pan(panel, now[0] - last[0], now[1] - last[1]);
    }
    to = now;
    frame.hidden = false;
    Object.assign(frame.style, {left: `${Math.min(from[0], to[0])}px`, top: `${Math.min(from[1], to[1])}px`,
      width: `${Math.abs(to[0] - from[0])}px`, height: `${Math.abs(to[1] - from[1])}px`});
  });
  const up = event => {
    touches.delete(event.pointerId);
    if (to && event.type === "pointerup" && tool() !== "move") {
      const {ox, oy, kx, ky} = panel.place, sorted = list => list.sort((a, b) => a - b);
      const x = sorted([from[0], to[0]].map(place => (place - ox) / kx)),
        y = sorted([from[1], to[1]].map(place => (place - oy) / ky));
      if (tool() === "zoom") look(panel, {x, y});
      else chooseAll(within(panel.kept, ...x, ...y), event.shiftKey || tool() === "select");
    }
    just = to !== null;
    end();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("click", event => {
    if (just) just = false;
      else if (tool() !== "zoom") choose(nearest(panel, ...at(event)), event.shiftKey || tool() === "select");
  });
  canvas.addEventListener("wheel", event => {
    if (!event.ctrlKey && tool() !== "zoom") return;  // the page scrolls
    event.preventDefault();
    zoom(panel, ZOOM ** Math.sign(event.deltaY), ...at(event));
  }, {passive: false});
  canvas.addEventListener("dblclick", () => look(panel, null));
  return {dragged: () => to !== null, end, at};
}
export function showChosen() {
  byId("chosen").hidden = !chosen.length;
  byId("chosen-title").textContent = chosen.length === 1 ? pointName(chosen[0]) : chosen.length
    ? `${chosen.length} points` : "";
  if (!chosen.length) return;
  const shown = chosen.slice(0, MOST_LISTED), body = byId("chosen-table").tBodies[0],
    head = byId("chosen-table").tHead;
  const named = Object.keys(project.quantities).filter(name => columns[name] &&
    shown.some(i => Number.isFinite(columns[name][i]) && columns[name][i] !== 0));
  const about = [
    ...channels.map(name => [label(RESIDUAL + name), i => written(columns[name][i] - own[name][i])]),
    ...named.filter(name => chosen.length === 1 || axisKnown(name)).map(name =>
      [`${label(name)}, as read`, i => trimmed(written(shownIn(name, (columns.read[name] || columns[name])[i])))]),
    ...(shown.some(i => left[i]) ? [["left out", i => left[i] ? whyLeftOut(i) || "yes" : ""]] : []),
  ];
  head.replaceChildren();
  if (chosen.length === 1) {
    body.replaceChildren(
      ...about.map(([title, text]) => rowOf(element("th", "", title), element("td", "n", text(chosen[0])))));
  } else {
    head.append(rowOf(element("th", "", "point"), ...about.map(([title]) => element("th", "n", title)),
      element("th", "")));
    body.replaceChildren(...shown.map(i =>
      rowOf(element("td", "", pointName(i)), ...about.map(([, text]) => element("td", "n", text(i))), unchoose(i))));
    if (shown.length < chosen.length) body.append(
      rowOf(element("td", "", `and ${chosen.length - shown.length} more`)));
  }
  labelled(byId("chosen-table"));
  byId("chosen-actions").replaceChildren(...hooks.chosenActions(),
    key("Choose none", "ends the choice (Esc in a picture)", () => choose(-1, false)));
}
function unchoose(i) {
  const cell = element("td", "n"), button = key("×", "take this point out of the choice", () => choose(i, true));
  button.setAttribute("aria-label", `take ${pointName(i)} out of the choice`);
  cell.append(button);
  return cell;
}
function step(panel, by, add) {
  const order = inOrder(panel.kept);
  if (!order.length) return;
  const at = order.indexOf(chosen[chosen.length - 1]);
  const next = order[((at < 0 && by < 0 ? 0 : at) + by + order.length) % order.length];
  if (add && isChosen[next]) select(chosen.slice(0, -1));  // back over the points that were added
  else chooseAll([next], add);
  tip(panel, next);
}

// ---- pictures
function addPanel({x, y}) {
  const figure = element("figure", "panel"), caption = element("figcaption", ""), plot = element("div", "plot");
  const panel = {x, y, canvas: document.createElement("canvas"), tip: element("div", "tip"),
    title: element("strong", "printed")};
  const options = {y: [...Object.keys(project.quantities).filter(axisKnown), ...channels.map(name => RESIDUAL + name)],
    x: Object.keys(project.quantities).filter(axisKnown)};
  for (const axis of ["y", "x"]) {
    const select = document.createElement("select");
    select.setAttribute("aria-label", axis === "y" ? "Upwards" : "Sideways");
    for (const name of options[axis]) select.append(new Option(label(name), name, false, name === panel[axis]));
    panel[axis] = select.value;
    select.addEventListener("change",
      () => { panel[axis] = select.value; panel.box = null; look(panel, null); remember(); listCoefficients(); });
    caption.append(...(axis === "x" ? [element("span", "on-screen", "over "), select] : [select]));
  }
  const close = key("×", "remove this picture", () => {
    state.panels = state.panels.filter(one => one !== panel);
    figure.remove();
    seen.unobserve(panel.canvas);
    remember();
    listCoefficients();
  });
  const more = element("details", "more"), menu = element("div", "");
  more.append(element("summary", "", "⋯"), menu);
  more.firstChild.setAttribute("aria-label", "save this picture");
  for (const [word, save] of [["picture (PNG)", savePicture], ["numbers (CSV)", saveNumbers]]) {
    menu.append(key(word, `save this ${word}`, () => { more.open = false; save(panel); }));
  }
  panel.whole = key("whole", "shows all again (0, or a double click)", () => look(panel, null));
  panel.whole.hidden = true;
  close.classList.add("close");
  caption.append(panel.whole, more, close, panel.title);
  panel.tip.hidden = true;
  panel.canvas.tabIndex = 0;
  panel.canvas.setAttribute("role", "img");
  panel.canvas.setAttribute("aria-label",
    "points and curves; arrow keys choose a point, with Shift several, Ctrl+A all; + and - zoom, 0 shows all");
  plot.append(panel.canvas, panel.tip);
  figure.append(caption, plot);
  byId("panels").append(figure);
  const drag = gestures(panel, plot);
  seen.observe(panel.canvas);
  panel.canvas.addEventListener("pointermove", event => {
    if (drag.dragged()) return tip(panel, -1);
    const i = nearest(panel, ...drag.at(event));
    tip(panel, i);
    if (i !== pointed) { setPointed(i); update(); }
  });
  panel.canvas.addEventListener("pointerleave", () => { tip(panel, -1); setPointed(-1); update(); });
  panel.canvas.addEventListener("keydown", event => {
    const steps = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (steps) { event.preventDefault(); step(panel, steps, event.shiftKey); }
    else if (event.key === "Escape") { if (!drag.dragged()) choose(-1, false); drag.end(); tip(panel, -1); }
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "a") {
      event.preventDefault();
      chooseAll(inOrder(panel.kept), false);
    }
    else if (["+", "=", "-"].includes(event.key) && !event.ctrlKey) zoom(panel, event.key === "-" ? ZOOM : 1 / ZOOM,
      panel.canvas.clientWidth / 2, panel.canvas.clientHeight / 2);
    else if (event.key === "0" && !event.ctrlKey) look(panel, null);
    else if (event.key === "Delete" && chosen.length) hooks.leaveOut();
  });
  state.panels.push(panel);
}
// While a slider moves, only pictures that are on the screen are drawn.
const seen = new IntersectionObserver(entries => {
  for (const entry of entries) {
    const panel = state.panels.find(one => one.canvas === entry.target);
    if (panel) panel.unseen = !entry.isIntersecting;
  }
});

// ---- filters
function listFacets() {
  byId("legend").replaceChildren();
  byId("facets").replaceChildren();
  const wide = project.points.facets.filter(one => one.as_range).map(one => one.name);
  for (const name of wide) delete state.hidden[name];
  for (const one of project.points.facets.filter(facet => facet.labels.length > 1 && !facet.as_range)) {
    const home = byId(one.name === state.colour ? "legend" : "facets"),
      present = one.labels.filter((_, k) => one.of.includes(k));
    if (present.length < 2) continue;
    const line = element("div", "facet");
    line.append(element("span", "word", one.word));
    const all = key("all", "show all", () => { delete state.hidden[one.name]; refilter(); });
    all.classList.add("chip");
    line.append(all);
    for (const text of present) line.append(chip(one, text));
    home.append(line);
  }
  for (const name of [...wide, "T", "t"]) {
    if (!axisKnown(name)) continue;
    const line = element("div", "facet range"), ends = [0, 1].map(k => {
      const field = Object.assign(element("input", "number"), {type: "number", step: "any"});
      field.setAttribute("aria-label", `${quantity(name).word} ${k ? "to" : "from"}`);
      field.value = (state.ranges[name] || [null, null])[k] ?? "";
      field.addEventListener("change", () => {
        const range = state.ranges[name] || [null, null];
        range[k] = Number.isFinite(field.valueAsNumber) ? field.valueAsNumber : null;
        state.ranges[name] = range;
        refilter();
      });
      return field;
    });
    line.append(element("span", "word", quantity(name).word), "from ", ends[0], " to ", ends[1],
      ` ${quantity(name).unit}`);
    byId("facets").append(line);
  }
}
// A click hides the group; with Shift, or twice, it shows it alone.
function chip(one, text) {
  const alone = () => { state.hidden[one.name] = one.labels.filter(other => other !== text); refilter(); };
  const made = key(text, "click: hide or show; with Shift, or double click: only this", event => {
    if (event.shiftKey) return alone();
    const hidden = new Set(state.hidden[one.name] || []);
    if (hidden.has(text)) hidden.delete(text); else hidden.add(text);
    state.hidden[one.name] = [...hidden];
    refilter();
  });
  made.addEventListener("dblclick", alone);
  made.classList.add("chip");
  made.dataset.facet = one.name;
  made.dataset.label = text;
  return made;
}
function refilter() {
  filter();
  showFacets();
  remember();
  update();
}
function showFacets() {
  for (const made of document.querySelectorAll(".facet .chip[data-facet]")) {
    const {facet: name, label: text} = made.dataset;
    made.setAttribute("aria-pressed", !(state.hidden[name] || []).includes(text));
    made.textContent = text;
    if (name === state.colour) {
      const mark = document.createElement("i");
      mark.style.background = palette[facet(name).labels.indexOf(text)];
      made.prepend(mark);
    }
  }
  const count = visible.reduce((sum, one) => sum + one, 0);
  byId("shown").textContent = `${count} of ${columns.count}`;
}

// ---- the address
export function remember() {
  const {hidden, ranges, colour, reading, bands, fit} = state,
    kept = {panels: state.panels.map(({x, y}) => ({x, y})), hidden, ranges, colour, reading, bands, fit, trial};
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(kept))}`);
}
function recalled() {
  try {
    return JSON.parse(decodeURIComponent(location.hash.slice(1)));
  } catch {
    return {};
  }
}

export async function showProject(data) {
  // with the model of these channels
  if (data.channels.some(channel => !(channel.name in MODELS))) return location.reload();
  const places = new Set(project ? chosen.map(pointName) : []);
  const other = data.others.find(one => one.title === state.fit), whole = await inflated(data.points.bytes);
  if (other) take({...data, ...other, points: data.points, over: other.points.layout, before: null}, whole,
    await inflated(other.points.bytes));
  else take(data, whole);
  state.fit = other ? other.title : data.title;
  byId("fit").replaceChildren(...[data,
    ...data.others].map(({title}) => new Option(title, title, false, title === state.fit)));
  byId("fit").parentNode.hidden = !data.others.length;
  byId("fit").onchange = event => {
    state.fit = event.target.value;
    setTrial({});
    dropMoves(one => one.trial);
    showProject(data).then(remember);
  };
  select(places.size ? [...columns.line.keys()].filter(i => places.has(pointName(i))) : []);
  byId("content").hidden = false;
  const names = project.points.facets.filter(one => one.labels.length > 1);
  byId("colour").replaceChildren(
    ...names.map(one => new Option(one.word, one.name, false, one.name === state.colour)));
  state.colour = byId("colour").value || project.points.facets[0].name;
  readTheme();
  recolour();
  filter();
  listFacets();
  showFacets();
  if (!state.panels.length) for (const panel of (wanted.length ? wanted : defaultPanels())) addPanel(panel);
  listCoefficients();
  const fit = project.channels.filter(one => one.of_fit).map(one =>
    `${one.name} ${written(one.rmse)} ${quantity(one.name).unit}`).join(", ");
  byId("content").classList.toggle("before", !channels.length);
  byId("verdict").textContent = project.verdict;
  byId("verdict").className = project.judgement;
  byId("about").textContent = !channels.length ? `${project.points.fitted} points; the fit is under way`
    : data.others.length || !project.verdict ? `${state.fit}: rms misfit ${fit}` : "";
  const said = project.warnings, box = byId("warnings");
  box.hidden = !said.length;
  box.open = !project.trusted;
  const many = said.length === 1 ? "1 warning" : `${said.length} warnings`;
  box.querySelector("summary").textContent = `${many} of the build`;
  box.querySelector("ul").replaceChildren(...said.map(sentence => element("li", "", sentence)));
  frame();
}
async function inflated(text) {
  const letters = atob(text), packed = new Uint8Array(letters.length);
  for (let i = 0; i < packed.length; i++) packed[i] = letters.charCodeAt(i);
  return new Uint8Array(
    await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}
function retheme() {
  if (!project) return;
  readTheme();
  recolour();
  showFacets();
  frame();  // at once, as paper does not wait
}
let wanted = [];
Object.assign(hooks, {update, move});
export async function begin(given) {
  const kept = recalled();
  wanted = Array.isArray(kept.panels) ? kept.panels : [];
  for (const name of ["hidden", "ranges"]) if (kept[name] && typeof kept[name] === "object") state[name] = kept[name];
  for (const name of ["colour", "fit"]) if (typeof kept[name] === "string") state[name] = kept[name];
  if (["curve", "felt", "read"].includes(kept.reading)) state.reading = kept.reading;
  for (const [name, value] of Object.entries(kept.trial || {})) if (Number.isFinite(value)) trial[name] = value;
  if (typeof kept.bands === "boolean") state.bands = kept.bands;
  byId("reading").value = state.reading;
  byId("bands").checked = state.bands;
  byId("find").addEventListener("input", find);
  byId("undo").addEventListener("click", undo);
  byId("reset").addEventListener("click", () => tryOut({}));
  byId("colour").addEventListener("change",
    event => { state.colour = event.target.value; recolour(); listFacets(); showFacets(); remember(); update(); });
  byId("bands").addEventListener("change", event => { state.bands = event.target.checked; remember(); update(); });
  byId("reading").addEventListener("change", event => { state.reading = event.target.value; remember(); update(); });
  byId("to-pictures").addEventListener("click", () => state.panels.length && state.panels[0].canvas.focus());
  for (const name of TOOLS) byId(name).addEventListener("click", () => {
    const pressed = tool() === name ? "" : name;
    for (const other of TOOLS) byId(other).setAttribute("aria-pressed", other === pressed);
    byId("panels").classList.toggle("dragging", pressed !== "");
  });
  byId("add").addEventListener("click", () => {
    addPanel(defaultPanels()[0]);
    remember();
    update();
    listCoefficients();
  });
  addEventListener("resize", update);
  whenPrinted(() => {
    for (const {title, x, y} of state.panels) title.textContent = `${label(y)} over ${label(x)}`;
    retheme();
  });
  onThemeChange(retheme);
  addEventListener("keydown", event => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" &&
      !["text", "search"].includes(event.target.type)) { event.preventDefault(); undo(); }
  });
  const old = "This browser cannot unpack the points; open the page in one of 2023 or later.";
  if (!globalThis.DecompressionStream) byId("about").textContent = old;
  else if (given) await showProject(given);
}

// For the console and for tests.
window.mffit = {
  misfit: name => { recompute(false); return misfit(name); },  // also before the next frame is drawn
  move: (name, value) => { move(name, value, true); frame(); },
  data: () => project,
  trial: () => trial,
  chosen: () => chosen,
  left: () => [...left],
  visible: () => visible,
  redraw: frame,
  choose,
  chooseAll,
  show: showProject,
  place: (panel, i) => { const {place: {X, Y}, kept: {px, py}} = state.panels[panel]; return [X(px[i]), Y(py[i])]; },
  box: panel => state.panels[panel].place.box,
  // Milliseconds of each of n frames in which a slider moves: computing and drawing.
  frames: (name, n) => {
    const times = [], [low, high] = coefficient[name].slider;
    for (let k = 0; k < n; k++) {
      const before = performance.now();
      trial[name] = low + (high - low) * (k + 1) / (n + 1);
      setDragging(true);
      showRow(coefficient[name]);
      frame();
      times.push(performance.now() - before);
    }
    delete trial[name];
    setDragging(false);
    showRow(coefficient[name]);
    frame();
    return times;
  },
};
