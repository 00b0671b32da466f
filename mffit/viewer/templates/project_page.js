// The page: what happens when something is moved, clicked or typed. The address keeps what is seen.
let dragging = false, pending = false, moves = [], dragFrom = null;

function move(name, value, final) {
  if (dragFrom === null) dragFrom = {...trial};
  if (value === coefficient[name].value) delete trial[name]; else trial[name] = value;
  dragging = !final;
  if (final) {
    moves.push({trial: dragFrom});
    dragFrom = null;
    remember();
  }
  showRow(coefficient[name]);
  update();
}
function update() {
  if (pending) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; frame(); });
}
function frame() {
  recompute();
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
  for (const name of names) showRow(coefficient[name]);
  remember();
  update();
}
function showMisfit() {
  const body = byId("misfit").tBodies[0], unit = name => quantity(name).unit;
  byId("misfit-before").hidden = !project.before;
  while (body.rows.length > channels.length) body.deleteRow(-1);
  channels.forEach((name, k) => {
    const line = body.rows[k] || body.insertRow(), now = misfits[name] ??= misfit(name), fit = fitMisfits[name] ??= misfit(name, fitOwn);
    if (!line.cells.length) for (let i = 0; i < 5; i++) line.insertCell().className = i ? "n" : "";
    line.cells[0].replaceChildren(shared.symbol(quantity(name)), ` [${unit(name)}]`);
    line.cells[1].textContent = written(now.rmse);
    line.cells[2].textContent = written(fit.rmse);
    line.cells[3].hidden = !project.before;
    line.cells[3].textContent = project.before && name in project.before.rmse ? written(project.before.rmse[name]) : "";
    line.cells[4].textContent = Number.isFinite(now.over_noise) ? now.over_noise.toFixed(2) : "–";
    line.cells[4].title = "root mean square of (model - reading) / u of the readings that state their uncertainty u";
  });
}

// ---- points: pointing, choosing
function tip(panel, i) {
  panel.tip.hidden = i < 0;
  if (i < 0) return;
  const points = project.points, places = panel.places;
  const lines = [[placeOf(i), ""], ...[panel.x, panel.y].map(name => [label(name), trimmed(written(name === panel.x ? places.px[i] : places.py[i]))])];
  panel.tip.replaceChildren(...lines.map(([word, text]) => {
    const line = element("div", "");
    line.append(element("span", "", word), element("b", "", text));
    return line;
  }));
  const right = places.X(places.px[i]) < panel.canvas.clientWidth / 2;
  panel.tip.style.left = right ? "auto" : "4px";
  panel.tip.style.right = right ? "4px" : "auto";
}
function placeOf(i) {
  const points = project.points, last = points.last[i];
  return `${points.files[points.file[i]]}:${points.line[i]}${last > points.line[i] ? `-${last}` : ""}`;
}
function choose(i, add) {
  if (i < 0) chosen = add ? chosen : [];
  else if (add) chosen = chosen.includes(i) ? chosen.filter(k => k !== i) : [...chosen, i];
  else chosen = [i];
  showChosen();
  update();
}
function chooseAll(members, add) {
  chosen = [...new Set([...(add ? chosen : []), ...members])];
  showChosen();
  update();
}
const pointsIn = panel => [...visible.keys()].filter(i => visible[i] && Number.isFinite(panel.places.px[i]) && Number.isFinite(panel.places.py[i]));
// The points in a rectangle of a picture, in its pixels.
function inside(panel, [x0, y0, x1, y1]) {
  const {X, Y, px, py} = panel.places, between = (x, a, b) => x >= Math.min(a, b) && x <= Math.max(a, b);
  return pointsIn(panel).filter(i => between(X(px[i]), x0, x1) && between(Y(py[i]), y0, y1));
}
// A rectangle is drawn with the mouse at once; with a finger, which otherwise scrolls, while "Select points" is on.
function rectangles(panel, plot) {
  const canvas = panel.canvas, frame = plot.appendChild(element("div", "rectangle"));
  let from = null, to = null, just = false;
  const at = event => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const end = () => { from = to = null; frame.hidden = true; };
  end();
  canvas.addEventListener("pointerdown", event => {
    just = false;
    if (event.button === 0 && (event.pointerType === "mouse" || selecting())) from = at(event);
  });
  canvas.addEventListener("pointermove", event => {
    if (!from) return;
    const now = at(event);
    if (!to && Math.hypot(now[0] - from[0], now[1] - from[1]) < NEAREST_DRAG) return;
    if (!to) canvas.setPointerCapture(event.pointerId);
    to = now;
    frame.hidden = false;
    Object.assign(frame.style, {left: `${Math.min(from[0], to[0])}px`, top: `${Math.min(from[1], to[1])}px`, width: `${Math.abs(to[0] - from[0])}px`, height: `${Math.abs(to[1] - from[1])}px`});
  });
  canvas.addEventListener("pointerup", event => {
    if (to) { just = true; chooseAll(inside(panel, [...from, ...to]), event.shiftKey || selecting()); }
    end();
  });
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("click", event => {
    if (just) just = false; else choose(nearest(panel, event), event.shiftKey || selecting());
  });
  return {dragged: () => to !== null, end};
}
const selecting = () => byId("select").getAttribute("aria-pressed") === "true";
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
  const order = pointsIn(panel)
    .sort((a, b) => panel.places.px[a] - panel.places.px[b] || panel.places.py[a] - panel.places.py[b]);
  if (!order.length) return;
  const at = order.indexOf(chosen[chosen.length - 1]);
  const next = order[((at < 0 && by < 0 ? 0 : at) + by + order.length) % order.length];
  if (add && chosen.includes(next)) chosen = chosen.slice(0, -1);  // back over the points that were added
  else chooseAll([next], add);
  showChosen();
  update();
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
    select.addEventListener("change", () => { panel[axis] = select.value; panel.box = null; remember(); update(); });
    caption.append(...(axis === "x" ? [element("span", "on-screen", "over "), select] : [select]));
  }
  const close = key("×", "remove this picture", () => {
    state.panels = state.panels.filter(one => one !== panel);
    figure.remove();
    remember();
  });
  close.classList.add("close");
  caption.append(close, panel.title);
  panel.tip.hidden = true;
  panel.canvas.tabIndex = 0;
  panel.canvas.setAttribute("role", "img");
  panel.canvas.setAttribute("aria-label", "points and curves; arrow keys choose a point, with Shift several, Ctrl+A all");
  plot.append(panel.canvas, panel.tip);
  figure.append(caption, plot);
  byId("panels").append(figure);
  const rectangle = rectangles(panel, plot);
  panel.canvas.addEventListener("pointermove", event => {
    if (rectangle.dragged()) return tip(panel, -1);
    const i = nearest(panel, event);
    tip(panel, i);
    if (i !== pointed) { pointed = i; update(); }
  });
  panel.canvas.addEventListener("pointerleave", () => { tip(panel, -1); pointed = -1; update(); });
  panel.canvas.addEventListener("keydown", event => {
    const steps = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (steps) { event.preventDefault(); step(panel, steps, event.shiftKey); }
    else if (event.key === "Escape") { if (!rectangle.dragged()) choose(-1, false); rectangle.end(); tip(panel, -1); }
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "a") { event.preventDefault(); chooseAll(pointsIn(panel), false); }
    else if (event.key === "Delete" && chosen.length) leaveOut();
  });
  state.panels.push(panel);
}
let leaveOut = () => {};
const axisKnown = name => columns[name] && columns[name].some(Number.isFinite) && (columns[name].some(x => x !== columns[name][0]));

// ---- filters
function listFacets() {
  const home = byId("facets");
  home.replaceChildren();
  const wide = project.points.facets.filter(one => one.as_range).map(one => one.name);
  for (const name of wide) delete state.hidden[name];
  for (const one of project.points.facets.filter(facet => facet.labels.length > 1 && !facet.as_range)) {
    const present = one.labels.filter((_, k) => one.of.includes(k));
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
    home.append(line);
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
  for (const made of byId("facets").querySelectorAll(".chip[data-facet]")) {
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
  const kept = {panels: state.panels.map(({x, y}) => ({x, y})), hidden: state.hidden, ranges: state.ranges, colour: state.colour, reading: state.reading, trial};
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(kept))}`);
}
function recalled() {
  try {
    return JSON.parse(decodeURIComponent(location.hash.slice(1)));
  } catch {
    return {};
  }
}

function showProject(data) {
  const places = project && columns.count ? chosen.map(placeOf) : [];
  take(data);
  chosen = places.map(place => project.points.line.findIndex((_, i) => placeOf(i) === place)).filter(i => i >= 0);
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
  showChosen();
  const fit = project.channels.filter(one => one.of_fit).map(one => `${one.name} ${written(one.rmse)} ${quantity(one.name).unit}`).join(", ");
  byId("about").textContent = `${project.points.fitted} points, rms misfit ${fit}${project.trusted ? "" : "; the result is not to be trusted"}`;
  const said = project.warnings, box = byId("warnings");
  box.hidden = !said.length;
  box.open = !project.trusted;
  box.querySelector("summary").textContent = `${said.length === 1 ? "1 warning" : `${said.length} warnings`} of the build`;
  box.querySelector("ul").replaceChildren(...said.map(sentence => element("li", "", sentence)));
  frame();
}
let wanted = [];
function begin() {
  const kept = recalled();
  wanted = Array.isArray(kept.panels) ? kept.panels : [];
  for (const name of ["hidden", "ranges"]) if (kept[name] && typeof kept[name] === "object") state[name] = kept[name];
  if (kept.colour) state.colour = kept.colour;
  if (["curve", "felt", "read"].includes(kept.reading)) state.reading = kept.reading;
  for (const [name, value] of Object.entries(kept.trial || {})) if (Number.isFinite(value)) trial[name] = value;
  byId("reading").value = state.reading;
  if (matchMedia("(max-width: 820px)").matches) byId("filters").open = false;
  byId("find").addEventListener("input", find);
  byId("undo").addEventListener("click", undo);
  byId("reset").addEventListener("click", () => {
    moves.push({trial: {...trial}});
    trial = {};
    rows.forEach(showRow);
    remember();
    update();
  });
  byId("colour").addEventListener("change", event => { state.colour = event.target.value; recolour(); showFacets(); remember(); update(); });
  byId("reading").addEventListener("change", event => { state.reading = event.target.value; remember(); update(); });
  byId("to-pictures").addEventListener("click", () => state.panels.length && state.panels[0].canvas.focus());
  byId("select").addEventListener("click", () => {
    byId("select").setAttribute("aria-pressed", !selecting());
    byId("panels").classList.toggle("selecting", selecting());
  });
  byId("add").addEventListener("click", () => { addPanel(defaultPanels()[0]); remember(); update(); });
  addEventListener("resize", update);
  shared.whenPrinted(() => {
    if (!project) return;
    for (const {title, x, y} of state.panels) title.textContent = `${label(y)} over ${label(x)}`;
    readTheme();
    frame();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { if (project) { readTheme(); update(); } });
  addEventListener("keydown", event => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !["text", "search"].includes(event.target.type)) { event.preventDefault(); undo(); }
  });
  if (project) showProject(project);
}

// For the console and for tests.
window.mffit = {
  evaluate: inputs => models["1"](...inputs),
  misfit: name => { recompute(); return misfit(name); },  // also before the next frame is drawn
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
  place: (panel, i) => { const p = state.panels[panel].places; return [p.X(p.px[i]), p.Y(p.py[i])]; },
  // What the curve of a point in a picture is at its place, in SI; null without a curve.
  onCurve: (panel, i) => {
    const {x, y} = state.panels[panel], group = groupsOver(parameterOf(x, y)).find(one => one.members.includes(i));
    return group ? evaluated(models, group, columns[parameterOf(x, y)][i])[y] : null;
  },
  shown: panel => { const p = state.panels[panel].places; return [[...p.px], [...p.py]]; },
  // Milliseconds of each of n frames in which a slider moves: computing and drawing.
  frames: (name, n) => {
    const times = [], start = coefficient[name].value, [low, high] = coefficient[name].slider;
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
