// Pictures: any quantity over any other, on canvas, because a picture has thousands of points.
const RESIDUAL = "residual of ";
const STEPS = 48, FEWEST_STEPS = 12, STEPS_OF_A_PICTURE = 9000, NARROWEST = 0.08, NEAR = 14, NEAREST_DRAG = 6, MOST_LISTED = 300, RIGHT = 10, TOP = 8, BOTTOM = 22, RATIO_OF_PAPER = 3;
const state = {panels: [], hidden: {}, ranges: {}, colour: "Fz", reading: "curve"};
let visible = new Uint8Array(0), theme = {}, palette = [], colourOf = [], curveGroups = {}, chosen = [], pointed = -1;
let version = 0;  // of all that decides where points and the curves of the fits are, and how they look

const facet = name => project.points.facets.find(one => one.name === name);
function defaultPanels() {
  const first = project.channels.filter(one => one.of_fit).map(one => one.name).slice(0, 2), levels = name => facet(name).labels.length;
  const over = name => name === "Fx" || levels("kappa") > levels("alpha") ? "kappa" : "alpha";
  return [...first.map(y => ({x: over(y), y})), ...first.map(y => ({x: over(y), y: RESIDUAL + y}))];
}
function readTheme() {
  const style = getComputedStyle(document.documentElement), of = name => style.getPropertyValue(`--${name}`).trim();
  theme = Object.fromEntries(["paper", "ink", "muted", "grid", "line", "accent"].map(name => [name, of(name)]));
  theme.dark = !shared.onPaper() && matchMedia("(prefers-color-scheme: dark)").matches;
  theme.colours = [0, 1, 2, 3, 4, 5, 6, 7].map(i => of(`c${i}`));
  theme.font = `11px ${getComputedStyle(document.body).fontFamily}`;
  recolour();
}
function recolour() {
  const by = facet(state.colour) || project.points.facets[0], many = by.labels.length;
  palette = by.labels.map((_, i) => many <= 8 ? theme.colours[i] : `hsl(${250 - 250 * i / (many - 1)} 70% ${theme.dark ? 62 : 42}%)`);
  colourOf = by.of;
  version++;
}
function filter() {
  const hidden = project.points.facets.map(one => [one, new Set(state.hidden[one.name] || [])]).filter(([, set]) => set.size);
  const ranges = Object.entries(state.ranges).filter(([name]) => columns[name]);
  visible = new Uint8Array(columns.count);
  for (let i = 0; i < columns.count; i++) {
    visible[i] = hidden.every(([one, set]) => !set.has(one.labels[one.of[i]]))
      && ranges.every(([name, [low, high]]) => {
        const x = shownIn(name, columns[name][i]);
        return Number.isNaN(x) || ((low === null || x >= low) && (high === null || x <= high));
      }) ? 1 : 0;
  }
  curveGroups = {};
  version++;
}
// Points of one curve over x: the same levels of everything else; with the median of their conditions.
function groupsOver(x) {
  if (curveGroups[x]) return curveGroups[x];
  const facets = project.points.facets.filter(one => !one.is_run && !one.inputs.includes(x));
  const found = new Map(), X = columns[x];
  for (let i = 0; i < columns.count; i++) {
    if (!visible[i]) continue;
    const key = facets.map(one => one.of[i]).join();
    if (!found.has(key)) found.set(key, []);
    found.get(key).push(i);
  }
  let low = Infinity, high = -Infinity;
  for (const members of found.values()) for (const i of members) { low = Math.min(low, X[i]); high = Math.max(high, X[i]); }
  const groups = [];
  for (const members of found.values()) {
    const at = members.map(i => X[i]), from = Math.min(...at), to = Math.max(...at);
    if (!(to - from > NARROWEST * (high - low))) continue;
    const fixed = project.order.map(name => median(members.map(i => columns[name][i])));
    groups.push({members, from, to, fixed, place: project.order.indexOf(x), mount: project.points.mount[members[0]]});
  }
  return curveGroups[x] = groups;
}
function median(list) {
  const sorted = Float64Array.from(list).sort(), k = sorted.length >> 1;
  return sorted.length % 2 ? sorted[k] : (sorted[k - 1] + sorted[k]) / 2;
}
function evaluated(by_mount, group, x) {
  const at = group.fixed.slice();
  at[group.place] = x;
  return by_mount[group.mount](...at);
}
// What a picture shows of every point: places in the units of the page.
function placed(panel) {
  const residual = panel.y.startsWith(RESIDUAL), y = residual ? panel.y.slice(RESIDUAL.length) : panel.y;
  const source = state.reading === "read" ? columns.read : columns;
  const X = source[panel.x] || columns[panel.x], n = columns.count;
  const along = channels.includes(y) ? parameterOf(panel.x, y) : null, over = along ? groupsOver(along) : [];
  const sx = quantity(panel.x).si, sy = quantity(y).si, px = new Float64Array(n), py = new Float64Array(n);
  for (let i = 0; i < n; i++) {
    px[i] = X[i] / sx;
    py[i] = residual ? (columns[y][i] - own[y][i]) / sy : (source[y] || columns[y])[i] / sy;
  }
  const curves = [], steps = Math.max(FEWEST_STEPS, Math.min(STEPS, Math.floor(STEPS_OF_A_PICTURE / over.length)));
  if (!residual && over.length) {
    for (const group of over) {
      if (state.reading === "curve") {
        for (const [name, places, size] of [[panel.x, px, sx], [y, py, sy]]) {
          if (!channels.includes(name)) continue;
          const shift = toTheCurve(group, along, name);
          group.members.forEach((i, k) => { places[i] += shift[k] / size; });
        }
      }
      curves.push({group, x: panel.x, y, sx, sy, from: group.from, to: group.to, steps});
    }
  }
  return {px, py, curves, residual, y};
}
// The input that runs along a curve: that of the axis; slip or sideslip where both axes are forces, as in a friction ellipse.
function parameterOf(x, y) {
  if (project.order.includes(x)) return x;
  if (x === y || !channels.includes(x)) return null;
  return [x, y].includes("Fx") && axisKnown("kappa") ? "kappa" : axisKnown("alpha") ? "alpha" : null;
}
// By how much the fitted model differs between a point's conditions and its curve's; sliders do not move the points.
function toTheCurve(group, x, y) {
  return (group.shift ??= {})[y] ??= group.members.map(i => evaluated(fitModels, group, columns[x][i])[y] - fitOwn[y][i]);
}
function fixedCurve(by_mount, curve) {
  const name = `${curve.x} ${curve.y} ${by_mount === fitModels ? "fit" : "before"}`;
  return (curve.group.kept ??= {})[name] ??= curvePoints(by_mount, curve, curve.steps);
}
function curvePoints(by_mount, curve, steps) {
  const points = [];
  for (let k = 0; k <= steps; k++) {
    const at = curve.from + (curve.to - curve.from) * k / steps, forces = evaluated(by_mount, curve.group, at);
    points.push([(curve.x in forces ? forces[curve.x] : at) / curve.sx, forces[curve.y] / curve.sy]);
  }
  return points;
}
function label(name) {
  const residual = name.startsWith(RESIDUAL), known = quantity(residual ? name.slice(RESIDUAL.length) : name);
  return `${residual ? RESIDUAL + known.symbol.replace("_", "") : known.word}${known.unit ? ` [${known.unit}]` : ""}`;
}

function draw(panel) {
  const canvas = panel.canvas, width = canvas.clientWidth, height = canvas.clientHeight, ratio = shared.onPaper() ? RATIO_OF_PAPER : devicePixelRatio || 1;
  if (!width) return;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d"), shown = placed(panel);
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  const lines = shown.curves.map(curve => ({curve, now: models === fitModels ? fixedCurve(models, curve) : curvePoints(models, curve, dragging ? Math.ceil(curve.steps / 2) : curve.steps)}));
  const box = limits(panel, shown, lines), rows_ = ticks(...box.y, 6);
  const start = 10 + 6.6 * Math.max(...rows_.map(tick => tick.text.length));
  const X = x => start + (x - box.x[0]) / (box.x[1] - box.x[0]) * (width - start - RIGHT);
  const Y = y => height - BOTTOM - (y - box.y[0]) / (box.y[1] - box.y[0]) * (height - TOP - BOTTOM);
  const frame = new Path2D();
  frame.rect(start - 3, TOP - 3, width - start - RIGHT + 6, height - TOP - BOTTOM + 6);
  // What a slider does not move is drawn once: axes, points and the curves of the fits.
  const still = on => {
    on.setTransform(ratio, 0, 0, ratio, 0, 0);
    on.font = theme.font;
    axes(on, {X, Y, box, start, width, height, rows_});
    on.save();
    on.clip(frame);
    dots(on, shown, X, Y);
    for (const {curve} of lines) {
      if (models !== fitModels) stroke(on, fixedCurve(fitModels, curve), X, Y, theme.muted, 1, [4, 3]);
      else if (beforeModels) stroke(on, fixedCurve(beforeModels, curve), X, Y, theme.muted, 1, [1, 3]);
    }
    on.restore();
  };
  if (shown.residual) still(pen);
  else {
    const name = [panel.x, panel.y, canvas.width, canvas.height, ratio, ...box.x, ...box.y, state.reading, models === fitModels, version].join();
    if (!panel.layer || panel.layer.name !== name) {
      const layer = Object.assign(document.createElement("canvas"), {width: canvas.width, height: canvas.height});
      still(layer.getContext("2d"));
      panel.layer = {name, layer};
    }
    pen.drawImage(panel.layer.layer, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = theme.font;
  }
  pen.save();
  pen.clip(frame);
  for (const {curve, now} of lines) stroke(pen, now, X, Y, palette[colourOf[curve.group.members[0]]], 2, []);
  marks(pen, shown, X, Y);
  pen.restore();
  if (channels.includes(shown.y)) {
    const {rmse, over_noise} = misfits[shown.y] ??= misfit(shown.y);
    const text = `misfit ${written(rmse)} ${quantity(shown.y).unit}${Number.isFinite(over_noise) ? `, ${over_noise.toFixed(2)} × noise` : ""}`;
    Object.assign(pen, {fillStyle: theme.muted, strokeStyle: theme.paper, lineWidth: 4, textAlign: "right"});
    pen.strokeText(text, width - RIGHT - 2, TOP + 9);  // readable over curves
    pen.fillText(text, width - RIGHT - 2, TOP + 9);
  }
  panel.places = {px: shown.px, py: shown.py, X, Y};
}
function limits(panel, shown, lines) {
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < shown.px.length; i++) {
    if (!visible[i] || !Number.isFinite(shown.px[i]) || !Number.isFinite(shown.py[i])) continue;
    if (shown.px[i] < x0) x0 = shown.px[i];
    if (shown.px[i] > x1) x1 = shown.px[i];
    if (shown.py[i] < y0) y0 = shown.py[i];
    if (shown.py[i] > y1) y1 = shown.py[i];
  }
  if (x0 > x1) return {x: [0, 1], y: [-1, 1]};
  for (const line of lines) {
    for (const [x, y] of line.now) {
      if (Number.isFinite(y)) { y0 = Math.min(y0, y); y1 = Math.max(y1, y); }
      if (channels.includes(panel.x) && Number.isFinite(x)) { x0 = Math.min(x0, x); x1 = Math.max(x1, x); }
    }
  }
  if (shown.residual || shown.curves.length) { y0 = Math.min(y0, 0); y1 = Math.max(y1, 0); }
  const wide = ([low, high]) => high - low > 1e-12 ? [low - 0.03 * (high - low), high + 0.03 * (high - low)] : [low - 1, high + 1];
  let box = {x: wide([x0, x1]), y: wide([y0, y1])};
  if (panel.box && dragging) {  // axes only grow while a slider moves, so that the curve is seen to move
    const grown = axis => [Math.min(box[axis][0], panel.box[axis][0]), Math.max(box[axis][1], panel.box[axis][1])];
    box = {x: grown("x"), y: grown("y")};
  }
  return panel.box = box;
}
function axes(pen, {X, Y, box, start, width, height, rows_}) {
  pen.lineWidth = 1;
  const line = (x1, y1, x2, y2, colour) => {
    pen.strokeStyle = colour;
    pen.beginPath();
    pen.moveTo(Math.round(x1) + .5, Math.round(y1) + .5);
    pen.lineTo(Math.round(x2) + .5, Math.round(y2) + .5);
    pen.stroke();
  };
  pen.fillStyle = theme.muted;
  pen.textAlign = "right";
  for (const tick of rows_) {
    line(start, Y(tick.x), width - RIGHT, Y(tick.x), theme.grid);
    pen.fillText(tick.text, start - 5, Y(tick.x) + 4);
  }
  pen.textAlign = "center";
  for (const tick of ticks(...box.x, Math.max(3, Math.min(8, (width - start) / 58)))) {
    line(X(tick.x), TOP, X(tick.x), height - BOTTOM, theme.grid);
    pen.fillText(tick.text, Math.min(X(tick.x), width - 3.6 * tick.text.length), height - 6);
  }
  if (box.x[0] <= 0 && box.x[1] >= 0) line(X(0), TOP, X(0), height - BOTTOM, theme.line);
  if (box.y[0] <= 0 && box.y[1] >= 0) line(start, Y(0), width - RIGHT, Y(0), theme.muted);
}
function dots(pen, shown, X, Y) {
  const size = columns.count > 3000 ? 2 : columns.count > 1200 ? 3 : 4, half = size / 2;
  const byColour = palette.map(() => []), out = [];
  for (let i = 0; i < columns.count; i++) {
    if (!visible[i] || Number.isNaN(shown.py[i]) || Number.isNaN(shown.px[i])) continue;
    if (left[i]) out.push(i);
    else if (colourOf[i] >= 0) byColour[colourOf[i]].push(i);
  }
  pen.globalAlpha = .72;
  byColour.forEach((members, k) => {  // a rectangle of whole pixels each: a path of thousands takes longer to fill
    pen.fillStyle = palette[k];
    for (const i of members) pen.fillRect(Math.round(X(shown.px[i]) - half), Math.round(Y(shown.py[i]) - half), size, size);
  });
  pen.globalAlpha = 1;
  pen.strokeStyle = theme.muted;
  pen.lineWidth = 1;
  pen.beginPath();
  for (const i of out) {
    const x = X(shown.px[i]), y = Y(shown.py[i]);
    pen.moveTo(x - 3, y - 3); pen.lineTo(x + 3, y + 3); pen.moveTo(x - 3, y + 3); pen.lineTo(x + 3, y - 3);
  }
  pen.stroke();
}
function stroke(pen, points, X, Y, colour, width, dash) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.beginPath();
  let open = false;
  for (const [x, y] of points) {
    if (!Number.isFinite(y)) { open = false; continue; }
    if (open) pen.lineTo(X(x), Y(y)); else pen.moveTo(X(x), Y(y));
    open = true;
  }
  pen.stroke();
  pen.setLineDash([]);
}
// The same points in every picture: those chosen by a click, and the one under the pointer.
function marks(pen, shown, X, Y) {
  for (const [members, width] of [[chosen, 2.5], [pointed >= 0 ? [pointed] : [], 1.5]]) {
    pen.strokeStyle = theme.ink;
    pen.lineWidth = width;
    for (const i of members) {
      if (!visible[i] || Number.isNaN(shown.py[i])) continue;
      pen.beginPath();
      pen.arc(X(shown.px[i]), Y(shown.py[i]), 6, 0, 2 * Math.PI);
      pen.stroke();
    }
  }
}
function nearest(panel, event) {
  const at = panel.canvas.getBoundingClientRect(), x = event.clientX - at.left, y = event.clientY - at.top, places = panel.places;
  let best = -1, least = NEAR ** 2;
  for (let i = 0; places && i < columns.count; i++) {
    if (!visible[i]) continue;
    const far = (places.X(places.px[i]) - x) ** 2 + (places.Y(places.py[i]) - y) ** 2;
    if (far < least) [best, least] = [i, far];
  }
  return best;
}
