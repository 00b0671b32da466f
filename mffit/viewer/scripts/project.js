// The part of a project: its fits, the misfit, and pictures of any quantity over any other.
import {choose, chooseAll, pointName, pointing, select} from "./choice.js";
import {dropMoves, find, listCoefficients, move, moves, tryOut, undo} from "./coefficients.js";
import {RESIDUAL, csvOf, defaultPanels} from "./curves.js";
import {byId, element, key, tell} from "./dom.js";
import {listFacets, showFacets} from "./filters.js";
import {
  axisKnown, channels, columns, filter, fitMisfits, fitOwn, hooks, left, misfit, misfits, project, quantity, recompute,
  setTrial, shownIn, state, take, trial, useOf, visible,
} from "./model.js";
import {
  addPanel, begin, dragging, frame, look, panels, recalled, remember, removePanel, retheme, update,
} from "./pictures.js";
import {chosen, drawAbove, drawMoving, drawStill, label, recolour, sceneOf} from "./points.js";
import {symbol, written} from "./text.js";

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
    if (line.dataset.name !== name) line.cells[0].replaceChildren(symbol(quantity(name)), ` [${unit(name)}]${
      project.channels[k].of_fit ? "" : ", apart from the fit"}`);
    line.dataset.name = name;
    const size = rmse => written(shownIn(name, rmse));
    const before = project.before && name in project.before.rmse ? size(project.before.rmse[name]) : "";
    const ratio = Number.isFinite(now.over_noise) ? now.over_noise.toFixed(2) : "–";
    [`${now.about ? "≈ " : ""}${size(now.rmse)}`, size(fit.rmse), before,
      ratio].forEach((text, i) => tell(line.cells[i + 1], text));
    line.cells[3].hidden = !project.before;
    line.cells[4].hidden = !noisy;
    line.cells[4].title = "root mean square of (model - reading) / u of the readings that state their uncertainty u";
  });
}

const byHand = {panels: false, colour: false};  // what nobody chose follows the points of the next fit

const projectPart = {
  ...pointing, scene: sceneOf, still: drawStill, moving: drawMoving, above: drawAbove,
  compute() { if (project) recompute(dragging); },
  told() {
    if (!project) return;
    showMisfit();
    byId("undo").disabled = !moves.length && !hooks.canUndo();
    byId("reset").disabled = !Object.keys(trial).length;
  },
  recolour() {
    if (!project) return;
    recolour();
    showFacets();
  },
  frame(panel, figure, caption, keys) {
    const title = element("strong", "printed"), known = Object.keys(project.quantities).filter(axisKnown);
    const options = {y: [...known, ...channels.map(name => RESIDUAL + name)], x: known};
    const tellAxes = () => {
      panel.words = {x: label(panel.x), y: label(panel.y)};
      title.textContent = `${panel.words.y} over ${panel.words.x}`;
    };
    const [upwards, sideways] = ["y", "x"].map(axis => {
      const list = element("select", "", options[axis].map(name => new Option(label(name), name)),
        {ariaLabel: axis === "y" ? "Upwards" : "Sideways", value: panel[axis]});
      if (!list.value) list.selectedIndex = 0;
      panel[axis] = list.value;
      list.onchange = () => {
        panel[axis] = list.value;
        panel.box = null;
        byHand.panels = true;
        tellAxes();
        look(panel, null);
        remember();
        listCoefficients();
      };
      return list;
    });
    tellAxes();
    caption.append(upwards, element("span", "on-screen", "over "), sideways, ...keys, key("×", "remove this picture",
      () => { byHand.panels = true; removePanel(panel); remember(); listCoefficients(); }, "small close"), title);
    panel.canvas.ariaLabel =
      "points and curves; arrow keys choose a point, with Shift several, Ctrl+A all; + and - zoom, 0 shows all";
  },
  csv: panel => csvOf(panel, label),
  kept() {
    const {hidden, ranges, reading, bands, fit} = state, colour = byHand.colour ? state.colour : null;
    const shown = byHand.panels ? panels.map(({x, y}) => ({x, y})) : null;
    return {panels: shown, hidden, ranges, colour, reading, bands, fit, trial};
  },
};

export async function showProject(data) {
  // with the model of these channels
  if (data.channels.some(channel => !(channel.name in MODELS[useOf(data)]))) return location.reload();
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
    ...names.map(one => new Option(one.word, one.name, false, byHand.colour && one.name === state.colour)));
  state.colour = byId("colour").value || project.points.facets[0].name;
  filter();
  listFacets();
  const proposed = wanted.length ? wanted : defaultPanels(), axes = all => all.map(({x, y}) => `${y} ${x}`).join();
  if (!byHand.panels && axes(panels) !== axes(proposed)) [...panels].forEach(removePanel);
  if (!panels.length) for (const panel of proposed) addPanel(panel);
  listCoefficients();
  const fit = project.channels.filter(one => one.of_fit).map(one =>
    `${one.name} ${written(shownIn(one.name, one.rmse))} ${quantity(one.name).unit}`).join(", ");
  document.body.classList.toggle("before", !channels.length);
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
  retheme();
}
async function inflated(text) {
  const letters = atob(text), packed = new Uint8Array(letters.length);
  for (let i = 0; i < packed.length; i++) packed[i] = letters.charCodeAt(i);
  return new Uint8Array(
    await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}
let wanted = [];  // pictures
export async function beginProject(given) {
  const kept = recalled();
  wanted = Array.isArray(kept.panels) ? kept.panels : [];
  byHand.panels = wanted.length > 0;
  byHand.colour = typeof kept.colour === "string";
  for (const name of ["hidden", "ranges"]) if (kept[name] && typeof kept[name] === "object") state[name] = kept[name];
  for (const name of ["colour", "fit"]) if (typeof kept[name] === "string") state[name] = kept[name];
  if (["curve", "felt", "read"].includes(kept.reading)) state.reading = kept.reading;
  for (const [name, value] of Object.entries(kept.trial || {})) if (Number.isFinite(value)) trial[name] = value;
  if (typeof kept.bands === "boolean") state.bands = kept.bands;
  byId("reading").value = state.reading;
  byId("bands").checked = state.bands;
  window.mffit = projectApi;
  begin(projectPart);
  byId("find").addEventListener("input", find);
  byId("undo").addEventListener("click", undo);
  byId("reset").addEventListener("click", () => tryOut({}));
  for (const [id, take] of [["bands", box => { state.bands = box.checked; }],
    ["reading", list => { state.reading = list.value; }],
    ["colour", list => { state.colour = list.value; byHand.colour = true; recolour(); listFacets(); showFacets(); }],
    ["add", () => { byHand.panels = true; addPanel(defaultPanels()[0]); listCoefficients(); }]]) {
    byId(id).addEventListener(id === "add" ? "click" : "change",
      event => { take(event.target); remember(); update(); });
  }
  addEventListener("keydown", event => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" &&
      !["text", "search"].includes(event.target.type)) { event.preventDefault(); undo(); }
  });
  const old = "This browser cannot unpack the points; open the page in one of 2023 or later.";
  if (!globalThis.DecompressionStream) byId("about").textContent = old;
  else if (given) await showProject(given);
}

// For the console and for tests.
const projectApi = {
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
  place: (panel, i) => { const {place: {X, Y}, kept: {px, py}} = panels[panel]; return [X(px[i]), Y(py[i])]; },
  box: panel => panels[panel].place.box,
};
