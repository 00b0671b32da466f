// Pictures: any quantity over any other. Points are set as pixels of one image, because a picture has up to a million
// of them.
import {BOTTOM, LETTER, RIGHT, TOP, axes, frameOf, over, penOf, placeOf, ring, stroke, theme} from "./axes.js";
import {
  MOST_MOVED, RESIDUAL, bandOf, beforeModels, changed, channels, columns, crosses, csvOf, curvePoints, dragging,
  extent, facet, fitModels, fixedCurve, hooks, isMoved, left, misfit, misfits, models, placed, project, quantity,
  state, version, visible,
} from "./model.js";
import {written} from "./text.js";

const NEAR = 14, LINE = 13;
export const NEAREST_DRAG = 6, MOST_LISTED = 300;
// places of a label along its curve, the best first
const LABELS_AT = [1, 0.92, 0.08, 0, 0.8, 0.2, 0.7, 0.3, 0.6, 0.4];
export let palette = [], chosen = [], isChosen = new Uint8Array(0), pointed = -1;
let inks = [];
const scratch = document.createElement("canvas");

export function setChosen(members) {
  if (Math.max(chosen.length, members.length) > MOST_LISTED) changed();  // inked among the points
  chosen = members;
  isChosen = new Uint8Array(columns.count);
  for (const i of chosen) isChosen[i] = 1;
}
export const setPointed = i => { pointed = i; };
export function recolour() {
  const by = facet(state.colour) || project.points.facets[0], many = by.labels.length;
  palette = by.labels.map((_, i) => many <= 8 ? theme.colours[i]
    : `hsl(${250 - 250 * i / (many - 1)} 70% ${theme.dark ? 62 : 42}%)`);
  inks = pixelsOf([...palette.map(colour => [colour, .72]), [theme.ink, 1]]);
  changed();
}
// Colours on the paper as pixels.
function pixelsOf(colours) {
  const canvas = Object.assign(document.createElement("canvas"), {width: colours.length, height: 1}),
    pen = canvas.getContext("2d");
  pen.fillStyle = theme.paper;
  pen.fillRect(0, 0, colours.length, 1);
  colours.forEach(([colour, alpha], i) => {
    pen.fillStyle = colour;
    pen.globalAlpha = alpha;
    pen.fillRect(i, 0, 1, 1);
  });
  return new Uint32Array(pen.getImageData(0, 0, colours.length, 1).data.buffer);
}
export function label(name) {
  const residual = name.startsWith(RESIDUAL), known = quantity(residual ? name.slice(RESIDUAL.length) : name);
  return `${residual ? RESIDUAL + known.symbol.replace("_", "") : known.word}${known.unit ? ` [${known.unit}]` : ""}`;
}

export function draw(panel) {
  if (dragging && panel.unseen) return;
  // asking for it lays out the page
  if (!dragging) panel.size = [panel.canvas.clientWidth, panel.canvas.clientHeight];
  const [width, height] = panel.size;
  if (!width) return;
  const {pen, ratio} = penOf(panel.canvas, width, height);
  paint(panel, pen, width, height, ratio);
}
function paint(panel, pen, width, height, ratio) {
  const shown = placed(panel);
  const lines = shown.curves.map(curve => ({curve, now: models === fitModels || !(isMoved(curve.x) || isMoved(curve.y))
    ? fixedCurve(fitModels, curve)
    : curvePoints(models, curve, dragging ? Math.ceil(curve.steps / 2) : curve.steps)}));
  const typical = typicalOf(lines), box = limits(panel, shown, lines);
  const place = panel.place = placeOf(box, width, height, ratio), frame = frameOf(place);
  // What a slider does not move is drawn once: axes, points and the curves of the fits.
  const still = on => {
    on.setTransform(ratio, 0, 0, ratio, 0, 0);
    axes(on, place);
    on.save();
    on.clip(frame);
    if (state.bands) for (const line of typical.values()) band(on, line.curve, place);
    dots(on, panel, shown, place);
    for (const {curve} of lines) {
      if (models !== fitModels) stroke(on, fixedCurve(fitModels, curve), place, theme.muted, 1, [4, 3]);
      else if (beforeModels) stroke(on, fixedCurve(beforeModels, curve), place, theme.muted, 1, [1, 3]);
    }
    on.restore();
  };
  const name = [panel.x, panel.y, width, height, ratio, ...box.x, ...box.y, state.reading, state.bands,
    models === fitModels, version, shown.serial].join();
  if (!panel.layer || panel.layer.name !== name) {
    const layer = Object.assign(document.createElement("canvas"),
      {width: Math.round(width * ratio), height: Math.round(height * ratio)});
    still(layer.getContext("2d"));
    panel.layer = {name, layer};
  }
  pen.drawImage(panel.layer.layer, 0, 0, width, height);
  pen.font = theme.font;
  pen.save();
  pen.clip(frame);
  const colour = curve => palette[columns.of[state.colour][curve.group.members[0]]];
  for (const {curve, now} of lines) stroke(pen, now, place, colour(curve), lines.length > 30 ? 1 : 2, []);
  marks(pen, shown, place);
  pen.restore();
  labels(pen, typical, lines, place);
  const said = [];
  if (channels.includes(shown.y)) {
    const {rmse, over_noise, about} = misfits[shown.y] ??= misfit(shown.y);
    const noise = Number.isFinite(over_noise) ? `, ${over_noise.toFixed(2)} × noise` : "";
    said.push(`misfit ${about ? "≈ " : ""}${written(rmse)} ${quantity(shown.y).unit}${noise}`);
  }
  const {drawn, of} = panel.count;
  if (drawn < of) said.push(`drawn ${drawn} of ${of}`);
  over(pen, said.join("; "), width - RIGHT - 2, TOP - 7, theme.muted);
}
function limits(panel, shown, lines) {
  if (panel.view) return panel.view;
  let [x0, x1, y0, y1] = shown.extent ??= extent(shown);
  if (x0 > x1) return {x: [0, 1], y: [-1, 1]};
  for (const {now} of lines) {
    for (let k = 0; k < now.length; k += 2) {
      const x = now[k], y = now[k + 1];
      if (y < y0) y0 = y;
      if (y > y1) y1 = y;
      if (x < x0) x0 = x;
      if (x > x1) x1 = x;
    }
  }
  const isNear = Math.min(Math.abs(y0), Math.abs(y1)) < y1 - y0;  // to zero; a radius is far from it
  if (shown.residual || (lines.length && isNear)) [y0, y1] = [Math.min(y0, 0), Math.max(y1, 0)];
  const wide = (low, high) => high - low > 1e-12 ? [low - 0.03 * (high - low), high + 0.03 * (high - low)]
    : [low - 1, high + 1];
  let box = {x: wide(x0, x1), y: wide(y0, y1)};
  if (panel.box && dragging) {  // axes only grow while a slider moves, so that the curve is seen to move, and in steps
    const grown = axis => {
      const [low, high] = box[axis], [first, last] = panel.box[axis], step = 0.2 * (last - first);
      return [low < first ? low - step : first, high > last ? high + step : last];
    };
    box = {x: grown("x"), y: grown("y")};
  }
  return panel.box = box;
}
// Sets a square for each point; of many, one for those that fall on the same pixel. `panel.at` has the row, from 1, by
// pixel.
function dots(on, panel, shown, {start, width, height, ratio, kx, ky, ox, oy}) {
  const size = Math.round((columns.count > 3000 ? 2 : columns.count > 1200 ? 3 : 4) * ratio), half = size >> 1;
  const w = Math.round(width * ratio), h = Math.round(height * ratio), image = new ImageData(w, h),
    pixels = new Uint32Array(image.data.buffer);
  const across = Math.ceil(width), at = panel.at = {rows: new Int32Array(across * Math.ceil(height)), across},
    out = [];
  const {px, py} = shown, of = columns.of[state.colour], inked = chosen.length > MOST_LISTED ? isChosen : null;
  const thinned = columns.count > MOST_MOVED, right = width - RIGHT + 3, low = height - BOTTOM + 3;
  let drawn = 0, all = 0;
  for (let i = 0; i < columns.count; i += shown.step) {
    if (!visible[i]) continue;
    const x = ox + kx * px[i], y = oy + ky * py[i];
    if (!(x >= start - 3 && x <= right && y >= TOP - 3 && y <= low)) continue;
    all += shown.step;
    const cell = Math.trunc(y) * across + Math.trunc(x), ink = inked && inked[i] ? palette.length : of[i];
    if (thinned && at.rows[cell] && ink < palette.length) continue;
    at.rows[cell] = i + 1;
    drawn++;
    if (left[i]) { out.push(x, y); continue; }
    if (ink < 0) continue;
    const first = Math.max(0, Math.round(x * ratio) - half), top = Math.max(0, Math.round(y * ratio) - half);
    for (let b = top; b < Math.min(h, top + size); b++) {
      for (let a = first; a < Math.min(w, first + size); a++) pixels[b * w + a] = inks[ink];
    }
  }
  panel.count = {drawn, of: Math.min(all, columns.count)};
  if (scratch.width !== w || scratch.height !== h) Object.assign(scratch, {width: w, height: h});
  scratch.getContext("2d").putImageData(image, 0, 0);
  on.drawImage(scratch, 0, 0, width, height);
  on.strokeStyle = theme.muted;
  on.lineWidth = 1;
  on.beginPath();
  for (let k = 0; k < out.length; k += 2) {
    const x = out[k], y = out[k + 1];
    on.moveTo(x - 3, y - 3); on.lineTo(x + 3, y + 3); on.moveTo(x - 3, y + 3); on.lineTo(x + 3, y - 3);
  }
  on.stroke();
}
// Where a further run is expected, 95 %, and its middle: the fit with its model error.
function band(pen, curve, {X, Y}) {
  const points = bandOf(curve), colour = palette[columns.of[state.colour][curve.group.members[0]]];
  if (points.length < 2) return;
  pen.globalAlpha = .13;
  pen.fillStyle = colour;
  pen.beginPath();
  for (const [x, low] of points) pen.lineTo(X(x), Y(low));
  for (const [x, , , high] of [...points].reverse()) pen.lineTo(X(x), Y(high));
  pen.fill();
  pen.globalAlpha = .8;
  pen.lineWidth = 1;
  pen.strokeStyle = colour;
  pen.setLineDash([2, 2]);
  pen.beginPath();
  for (const [x, , middle] of points) pen.lineTo(X(x), Y(middle));
  pen.stroke();
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}
// By level of the colour, the curve of most points: it has a band and a label.
function typicalOf(lines) {
  const of = columns.of[state.colour], found = new Map();
  for (const line of lines) {
    const level = of[line.curve.group.members[0]], other = found.get(level);
    if (level >= 0 && (!other || other.curve.group.n < line.curve.group.n)) found.set(level, line);
  }
  return found;
}
// The level of each colour beside its curve, where there is room and the fewest curves pass below it.
function labels(pen, typical, lines, {X, Y, start, width, height}) {
  const words = facet(state.colour).labels, taken = [];
  if (words.length < 2) return;
  for (const [level, {now}] of typical) {
    const long = LETTER * words[level].length, last = now.length / 2 - 1;
    let best = null;
    for (const share of LABELS_AT) {
      const k = 2 * Math.round(share * last), x = Math.min(width - RIGHT - 2,
        Math.max(start + long + 4, X(now[k]) + (share < .5 ? long : 0))), y = Y(now[k + 1]) - 5;
      const own = [x - long, y - LINE + 2, x, y + 2];
      if (!(y > TOP + LINE - 2 && y < height - BOTTOM) ||
        taken.some(box => own[0] < box[2] && own[2] > box[0] && own[1] < box[3] && own[3] > box[1])) continue;
      const below = lines.filter(line => crosses(line.now, own, X, Y)).length;
      if (!best || below < best.below) best = {below, own, x, y};
      if (!below) break;
    }
    if (!best) continue;
    taken.push(best.own);
    over(pen, words[level], best.x, best.y, palette[level]);
  }
}
// The same points in every picture: those chosen by a click, and the one under the pointer. Many are inked as pixels
// instead.
function marks(pen, shown, {X, Y}) {
  for (const [members, width] of [[chosen.length > MOST_LISTED ? [] : chosen, 2.5],
    [pointed >= 0 ? [pointed] : [], 1.5]]) {
    for (const i of members) {
      if (visible[i] && !Number.isNaN(shown.py[i])) ring(pen, X(shown.px[i]), Y(shown.py[i]), 6, theme.ink, width);
    }
  }
}
// The point nearest to a place of the picture; -1 without one.
export function nearest(panel, x, y) {
  const {rows, across} = panel.at, {X, Y} = panel.place, {px, py} = panel.kept;
  let best = -1, least = NEAR ** 2;
  for (let b = Math.max(0, Math.trunc(y) - NEAR); b <= y + NEAR; b++) {
    for (let a = Math.max(0, Math.trunc(x) - NEAR); a <= Math.min(across - 1, x + NEAR); a++) {
      const i = rows[b * across + a] - 1;
      if (!(i >= 0)) continue;
      const far = (X(px[i]) - x) ** 2 + (Y(py[i]) - y) ** 2;
      if (far < least) [best, least] = [i, far];
    }
  }
  return best;
}

// ---- zoom, and pictures as files
export const ZOOM = 1.25;
const boxOf = panel => panel.view || panel.place.box;
// The view widened by a factor about a place of the picture, or shifted by pixels.
export function zoom(panel, factor, x, y) {
  const {ox, oy, kx, ky} = panel.place, box = boxOf(panel),
    about = ([low, high], at) => [at + (low - at) * factor, at + (high - at) * factor];
  look(panel, {x: about(box.x, (x - ox) / kx), y: about(box.y, (y - oy) / ky)});
}
export function pan(panel, dx, dy) {
  const {kx, ky} = panel.place, box = boxOf(panel);
  look(panel, {x: box.x.map(at => at - dx / kx), y: box.y.map(at => at - dy / ky)});
}
export function look(panel, view) {
  panel.view = view;
  panel.whole.hidden = !view;
  hooks.update();
}
function saved(name, content, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], {type}));
  link.download = `${project.name} ${name}`.replace(/[^\w.-]+/g, "_");
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
const nameOf = panel => `${panel.y.replace(RESIDUAL, "residual_")}_over_${panel.x}`;
export function savePicture(panel) {
  const scale = 2, head = 26, foot = 18, {clientWidth: width, clientHeight: height} = panel.canvas;
  const canvas = Object.assign(document.createElement("canvas"),
    {width: scale * width, height: scale * (height + head + foot)}), pen = canvas.getContext("2d");
  const inner = Object.assign(document.createElement("canvas"), {width: scale * width, height: scale * height}),
    on = inner.getContext("2d");
  on.setTransform(scale, 0, 0, scale, 0, 0);
  paint(panel, on, width, height, scale);
  pen.fillStyle = theme.paper;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(inner, 0, scale * head);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  Object.assign(pen, {font: theme.font.replace("11px", "12px"), fillStyle: theme.ink});
  pen.fillText(`${label(panel.y)} — ${project.name}`, 8, 17);
  pen.textAlign = "right";
  pen.fillText(label(panel.x), width - RIGHT, height + head + foot - 5);
  canvas.toBlob(blob => saved(`${nameOf(panel)}.png`, blob, "image/png"));
  hooks.update();
}
export const saveNumbers = panel => saved(`${nameOf(panel)}.csv`, csvOf(panel, label), "text/csv");
