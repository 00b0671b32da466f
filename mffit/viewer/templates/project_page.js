// The page: what happens when something is moved, clicked or typed. The address keeps what is seen.
const RESTS_AFTER = 250;  // [ms]
let dragging = false, pending = false, moves = [], dragFrom = null, resting = 0;

function move(name, value, final) {
  if (dragFrom === null) dragFrom = {...trial};
  if (value === coefficient[name].value) delete trial[name]; else trial[name] = value;
  dragging = !final;
  clearTimeout(resting);
  if (!final) resting = setTimeout(() => { dragging = false; update(); }, RESTS_AFTER);  // all points follow a slider that is held still
  if (final) {
    moves.push({trial: dragFrom});
    dragFrom = null;
    remember();
  }
  showRow(coefficient[name]);
  update();
}
// Values by name in place of those of the fit; others stay as fitted.
function tryOut(values) {
  moves.push({trial: {...trial}});
  trial = Object.fromEntries(Object.entries(project.values).filter(([name, x]) => name in values && values[name] !== x).map(([name]) => [name, values[name]]));
  rows.forEach(showRow);
  remember();
  update();
}
function update() {
  if (pending || !project) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; frame(); });
}
function frame() {
  recompute(dragging);
  for (const panel of state.panels) draw(panel);
  showMisfit();
  byId("undo").disabled = !moves.length && !canUndo();
  byId("reset").disabled = !Object.keys(trial).length;
}
let canUndo = () => false, undoEdit = () => {};
function undo() {
  const last = moves.pop();
  if (!last || !last.trial) return undoEdit();
  const names = new Set([...Object.keys(trial), ...Object.keys(last.trial)]);
  trial = last.trial;
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
    const line = body.rows[k] || body.insertRow(), now = misfits[name] ??= misfit(name), fit = fitMisfits[name] ??= misfit(name, fitOwn);
    if (!line.cells.length) for (let i = 0; i < 5; i++) line.insertCell().className = i ? "n" : "";
    if (line.dataset.name !== name) line.cells[0].replaceChildren(shared.symbol(quantity(name)), ` [${unit(name)}]`);
    line.dataset.name = name;
    const before = project.before && name in project.before.rmse ? written(project.before.rmse[name]) : "";
    const ratio = Number.isFinite(now.over_noise) ? now.over_noise.toFixed(2) : "–";
    [`${now.about ? "≈ " : ""}${written(now.rmse)}`, written(fit.rmse), before, ratio].forEach((text, i) => tell(line.cells[i + 1], text));
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
  const lines = [[placeOf(i), ""], ...[[panel.x, px], [panel.y, py]].map(([name, at]) => [label(name), trimmed(written(at[i]))])];
  panel.tip.replaceChildren(...lines.map(([word, text]) => {
    const line = element("div", "");
    line.append(element("span", "", word), element("b", "", text));
    return line;
  }));
  const right = panel.place.X(px[i]) < panel.canvas.clientWidth / 2;
  panel.tip.style.left = right ? "auto" : "4px";
  panel.tip.style.right = right ? "4px" : "auto";
}
function placeOf(i) {
  const first = columns.line[i], last = columns.last[i];
  return `${project.points.files[columns.file[i]]}:${first}${last > first ? `-${last}` : ""}`;
}
function choose(i, add) {
  if (i < 0) setChosen(add ? chosen : []);
  else if (add) setChosen(isChosen[i] ? chosen.filter(k => k !== i) : [...chosen, i]);
  else setChosen([i]);
}
function chooseAll(members, add) {
  setChosen(add ? chosen.concat([...members].filter(i => !isChosen[i])) : [...members]);
}
function setChosen(members) {
  if (Math.max(chosen.length, members.length) > MOST_LISTED) version++;  // inked among the points
  chosen = members;
  isChosen = new Uint8Array(columns.count);
  for (const i of chosen) isChosen[i] = 1;
  showChosen();
  update();
}
// What a drag in a picture does: a rectangle chooses points or becomes the view, or the picture is moved. Without a button of
// these pressed, that of a mouse chooses points, and a finger moves the page; two fingers zoom.
const TOOLS = ["select", "zoom", "move"];
const tool = () => TOOLS.find(name => byId(name).getAttribute("aria-pressed") === "true") || "";
function gestures(panel, plot) {
  const canvas = panel.canvas, frame = plot.appendChild(element("div", "rectangle")), touches = new Map();
  let from = null, to = null, just = false;
  const at = event => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const end = () => { from = to = null; frame.hidden = true; };
  end();
  canvas.addEventListener("touchstart", event => { if (event.touches.length > 1) event.preventDefault(); }, {passive: false});  // the page stays
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
    Object.assign(frame.style, {left: `${Math.min(from[0], to[0])}px`, top: `${Math.min(from[1], to[1])}px`, width: `${Math.abs(to[0] - from[0])}px`, height: `${Math.abs(to[1] - from[1])}px`});
  });
  const up = event => {
    touches.delete(event.pointerId);
    if (to && event.type === "pointerup" && tool() !== "move") {
      const {ox, oy, kx, ky} = panel.place, sorted = list => list.sort((a, b) => a - b);
      const x = sorted([from[0], to[0]].map(place => (place - ox) / kx)), y = sorted([from[1], to[1]].map(place => (place - oy) / ky));
      if (tool() === "zoom") look(panel, {x, y});
      else chooseAll(within(panel.kept, ...x, ...y), event.shiftKey || tool() === "select");
    }
    just = to !== null;
    end();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("click", event => {
    if (just) just = false; else if (tool() !== "zoom") choose(nearest(panel, ...at(event)), event.shiftKey || tool() === "select");
  });
  canvas.addEventListener("wheel", event => {
    if (!event.ctrlKey && tool() !== "zoom") return;  // the page scrolls
    event.preventDefault();
    zoom(panel, ZOOM ** Math.sign(event.deltaY), ...at(event));
  }, {passive: false});
  canvas.addEventListener("dblclick", () => look(panel, null));
  return {dragged: () => to !== null, end, at};
}
let chosenActions = () => [];
function showChosen() {
  byId("chosen").hidden = !chosen.length;
  byId("chosen-title").textContent = chosen.length === 1 ? placeOf(chosen[0]) : chosen.length ? `${chosen.length} points` : "";
  if (!chosen.length) return;
  const shown = chosen.slice(0, MOST_LISTED), body = byId("chosen-table").tBodies[0], head = byId("chosen-table").tHead;
  const named = Object.keys(project.quantities).filter(name => columns[name] && shown.some(i => Number.isFinite(columns[name][i]) && columns[name][i] !== 0));
  const about = [
    ...channels.map(name => [label(RESIDUAL + name), i => written(columns[name][i] - own[name][i])]),
    ...named.filter(name => chosen.length === 1 || axisKnown(name)).map(name => [`${label(name)}, as read`, i => trimmed(written(shownIn(name, (columns.read[name] || columns[name])[i])))]),
    ...(shown.some(i => left[i]) ? [["left out", i => left[i] ? whyLeftOut(i) || "yes" : ""]] : []),
  ];
  head.replaceChildren();
  if (chosen.length === 1) {
    body.replaceChildren(...about.map(([title, text]) => rowOf(element("th", "", title), element("td", "n", text(chosen[0])))));
  } else {
    head.append(rowOf(element("th", "", "point"), ...about.map(([title]) => element("th", "n", title)), element("th", "")));
    body.replaceChildren(...shown.map(i => rowOf(element("td", "", placeOf(i)), ...about.map(([, text]) => element("td", "n", text(i))), unchoose(i))));
    if (shown.length < chosen.length) body.append(rowOf(element("td", "", `and ${chosen.length - shown.length} more`)));
  }
  shared.labelled(byId("chosen-table"));
  byId("chosen-actions").replaceChildren(...chosenActions(), key("Choose none", "ends the choice (Esc in a picture)", () => choose(-1, false)));
}
function rowOf(...inside) {
  const made = document.createElement("tr");
  made.append(...inside);
  return made;
}
function unchoose(i) {
  const cell = element("td", "n"), button = key("×", "take this point out of the choice", () => choose(i, true));
  button.setAttribute("aria-label", `take ${placeOf(i)} out of the choice`);
  cell.append(button);
  return cell;
}
function step(panel, by, add) {
  const order = inOrder(panel.kept);
  if (!order.length) return;
  const at = order.indexOf(chosen[chosen.length - 1]);
  const next = order[((at < 0 && by < 0 ? 0 : at) + by + order.length) % order.length];
  if (add && isChosen[next]) setChosen(chosen.slice(0, -1));  // back over the points that were added
  else chooseAll([next], add);
  tip(panel, next);
}

// ---- pictures
function addPanel({x, y}) {
  const figure = element("figure", "panel"), caption = element("figcaption", ""), plot = element("div", "plot");
  const panel = {x, y, canvas: document.createElement("canvas"), tip: element("div", "tip"), title: element("strong", "printed")};
  const options = {y: [...Object.keys(project.quantities).filter(axisKnown), ...channels.map(name => RESIDUAL + name)], x: Object.keys(project.quantities).filter(axisKnown)};
  for (const axis of ["y", "x"]) {
    const select = document.createElement("select");
    select.setAttribute("aria-label", axis === "y" ? "Upwards" : "Sideways");
    for (const name of options[axis]) select.append(new Option(label(name), name, false, name === panel[axis]));
    panel[axis] = select.value;
    select.addEventListener("change", () => { panel[axis] = select.value; panel.box = null; look(panel, null); remember(); });
    caption.append(...(axis === "x" ? [element("span", "on-screen", "over "), select] : [select]));
  }
  const close = key("×", "remove this picture", () => {
    state.panels = state.panels.filter(one => one !== panel);
    figure.remove();
    seen.unobserve(panel.canvas);
    remember();
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
  panel.canvas.setAttribute("aria-label", "points and curves; arrow keys choose a point, with Shift several, Ctrl+A all; + and - zoom, 0 shows all");
  plot.append(panel.canvas, panel.tip);
  figure.append(caption, plot);
  byId("panels").append(figure);
  const drag = gestures(panel, plot);
  seen.observe(panel.canvas);
  panel.canvas.addEventListener("pointermove", event => {
    if (drag.dragged()) return tip(panel, -1);
    const i = nearest(panel, ...drag.at(event));
    tip(panel, i);
    if (i !== pointed) { pointed = i; update(); }
  });
  panel.canvas.addEventListener("pointerleave", () => { tip(panel, -1); pointed = -1; update(); });
  panel.canvas.addEventListener("keydown", event => {
    const steps = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (steps) { event.preventDefault(); step(panel, steps, event.shiftKey); }
    else if (event.key === "Escape") { if (!drag.dragged()) choose(-1, false); drag.end(); tip(panel, -1); }
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "a") { event.preventDefault(); chooseAll(inOrder(panel.kept), false); }
    else if (["+", "=", "-"].includes(event.key) && !event.ctrlKey) zoom(panel, event.key === "-" ? ZOOM : 1 / ZOOM, panel.canvas.clientWidth / 2, panel.canvas.clientHeight / 2);
    else if (event.key === "0" && !event.ctrlKey) look(panel, null);
    else if (event.key === "Delete" && chosen.length) leaveOut();
  });
  state.panels.push(panel);
}
let leaveOut = () => {};
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
    const home = byId(one.name === state.colour ? "legend" : "facets"), present = one.labels.filter((_, k) => one.of.includes(k));
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
    line.append(element("span", "word", quantity(name).word), "from ", ends[0], " to ", ends[1], ` ${quantity(name).unit}`);
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
function remember() {
  const {hidden, ranges, colour, reading, bands, fit} = state, kept = {panels: state.panels.map(({x, y}) => ({x, y})), hidden, ranges, colour, reading, bands, fit, trial};
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(kept))}`);
}
function recalled() {
  try {
    return JSON.parse(decodeURIComponent(location.hash.slice(1)));
  } catch {
    return {};
  }
}

async function showProject(data) {
  if (data.channels.some(channel => !(channel.name in MODELS))) return location.reload();  // with the model of these channels
  const places = new Set(project ? chosen.map(placeOf) : []);
  const other = data.others.find(one => one.title === state.fit), whole = await inflated(data.points.bytes);
  if (other) take({...data, ...other, points: data.points, over: other.points.layout, before: null}, whole, await inflated(other.points.bytes));
  else take(data, whole);
  state.fit = other ? other.title : data.title;
  byId("fit").replaceChildren(...[data, ...data.others].map(({title}) => new Option(title, title, false, title === state.fit)));
  byId("fit").parentNode.hidden = !data.others.length;
  byId("fit").onchange = event => {
    state.fit = event.target.value;
    trial = {};
    moves = moves.filter(one => !one.trial);
    showProject(data).then(remember);
  };
  setChosen(places.size ? [...columns.line.keys()].filter(i => places.has(placeOf(i))) : []);
  byId("content").hidden = false;
  const names = project.points.facets.filter(one => one.labels.length > 1);
  byId("colour").replaceChildren(...names.map(one => new Option(one.word, one.name, false, one.name === state.colour)));
  state.colour = byId("colour").value || project.points.facets[0].name;
  readTheme();
  filter();
  listFacets();
  showFacets();
  if (!state.panels.length) for (const panel of (wanted.length ? wanted : defaultPanels())) addPanel(panel);
  listCoefficients();
  const fit = project.channels.filter(one => one.of_fit).map(one => `${one.name} ${written(one.rmse)} ${quantity(one.name).unit}`).join(", ");
  byId("about").textContent = `${data.others.length ? `${state.fit}: ` : ""}${project.points.fitted} points, rms misfit ${fit}${project.trusted ? "" : "; the result is not to be trusted"}`;
  const said = project.warnings, box = byId("warnings");
  box.hidden = !said.length;
  box.open = !project.trusted;
  box.querySelector("summary").textContent = `${said.length === 1 ? "1 warning" : `${said.length} warnings`} of the build`;
  box.querySelector("ul").replaceChildren(...said.map(sentence => element("li", "", sentence)));
  frame();
}
async function inflated(text) {
  const letters = atob(text), packed = new Uint8Array(letters.length);
  for (let i = 0; i < packed.length; i++) packed[i] = letters.charCodeAt(i);
  return new Uint8Array(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
}
function retheme() {
  if (!project) return;
  readTheme();
  showFacets();
  frame();  // at once, as paper does not wait
}
let wanted = [];
async function begin() {
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
  byId("colour").addEventListener("change", event => { state.colour = event.target.value; recolour(); listFacets(); showFacets(); remember(); update(); });
  byId("bands").addEventListener("change", event => { state.bands = event.target.checked; remember(); update(); });
  byId("reading").addEventListener("change", event => { state.reading = event.target.value; remember(); update(); });
  byId("to-pictures").addEventListener("click", () => state.panels.length && state.panels[0].canvas.focus());
  for (const name of TOOLS) byId(name).addEventListener("click", () => {
    const pressed = tool() === name ? "" : name;
    for (const other of TOOLS) byId(other).setAttribute("aria-pressed", other === pressed);
    byId("panels").classList.toggle("dragging", pressed !== "");
  });
  byId("add").addEventListener("click", () => { addPanel(defaultPanels()[0]); remember(); update(); });
  addEventListener("resize", update);
  shared.whenPrinted(() => {
    for (const {title, x, y} of state.panels) title.textContent = `${label(y)} over ${label(x)}`;
    retheme();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", retheme);
  addEventListener("keydown", event => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !["text", "search"].includes(event.target.type)) { event.preventDefault(); undo(); }
  });
  if (!globalThis.DecompressionStream) byId("about").textContent = "This browser cannot unpack the points; open the page in one of 2023 or later.";
  else if (content.project) await showProject(content.project);
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
      dragging = true;
      showRow(coefficient[name]);
      frame();
      times.push(performance.now() - before);
    }
    delete trial[name];
    dragging = false;
    showRow(coefficient[name]);
    frame();
    return times;
  },
};
