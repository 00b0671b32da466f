// The points of a project in its pictures, and the curves of the fit. Points are set as pixels of one image, because a
// picture has up to a million of them.
import {BOTTOM, LETTER, RIGHT, TOP, over, ring, roomy, stroke, theme} from "./axes.js";
import {RESIDUAL, bandOf, crosses, extent, fixedCurve, placed, pointsOf} from "./curves.js";
import {canvasOf} from "./dom.js";
import {
  MOST_MOVED, beforeModels, changed, channels, columns, facet, fitModels, isMoved, left, misfit, misfits, models,
  project, quantity, shownIn, state, version, visible,
} from "./model.js";
import {dragging} from "./pictures.js";
import {named, written} from "./text.js";

const NEAR = 14, LINE = 13;
export const MOST_LISTED = 300;
// places of a label along its curve, the best first
const LABELS_AT = [1, 0.92, 0.08, 0, 0.8, 0.2, 0.7, 0.3, 0.6, 0.4];
export let palette = [], chosen = [], isChosen = new Uint8Array(0), pointed = -1;
let inks = [];
const scratch = canvasOf(1, 1);

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
  const pen = canvasOf(colours.length, 1).getContext("2d");
  pen.fillStyle = theme.paper;
  pen.fillRect(0, 0, colours.length, 1);
  colours.forEach(([colour, alpha], i) => {
    pen.fillStyle = colour;
    pen.globalAlpha = alpha;
    pen.fillRect(i, 0, 1, 1);
  });
  return new Uint32Array(pen.getImageData(0, 0, colours.length, 1).data.buffer);
}
export const channelOf = name => name.replace(RESIDUAL, "");
export function label(name) {
  const known = quantity(channelOf(name));
  return named({...known, word: name === channelOf(name) ? known.word : RESIDUAL + known.symbol.replace("_", "")});
}

export function sceneOf(panel) {
  const shown = placed(panel);
  const isFit = ({x, y}) => models === fitModels || !(isMoved(x) || isMoved(y));
  panel.curves = shown.curves.map(curve => ({curve, now: isFit(curve) ? fixedCurve(fitModels, curve)
    : pointsOf(models, curve, dragging ? Math.ceil(curve.steps / 2) : curve.steps)}));
  panel.typical = typicalOf(panel.curves);
  const name = [panel.x, panel.y, state.reading, state.bands, models === fitModels, version, shown.serial].join();
  return {name, box: endsOf(shown, panel.curves)};
}
// What a slider does not move: points, bands and the curves of the fits.
export function drawStill(on, panel, place) {
  if (state.bands) for (const line of panel.typical.values()) band(on, line.curve, place);
  dots(on, panel, panel.kept, place);
  for (const {curve} of panel.curves) {
    if (models !== fitModels) stroke(on, fixedCurve(fitModels, curve), place, theme.muted, 1, [4, 3]);
    else if (beforeModels) stroke(on, fixedCurve(beforeModels, curve), place, theme.muted, 1, [1, 3]);
  }
}
export function drawMoving(pen, panel, place) {
  const width = panel.curves.length > 30 ? 1 : 2;
  for (const {curve, now} of panel.curves) stroke(pen, now, place, colourOf(curve), width, []);
  marks(pen, panel.kept, place);
}
export function drawAbove(pen, panel, place) {
  const {y} = panel.kept, {drawn, of} = panel.count, said = [];
  labels(pen, panel.typical, panel.curves, place);
  if (channels.includes(y)) {
    const {rmse, over_noise, about} = misfits[y] ??= misfit(y);
    const noise = Number.isFinite(over_noise) ? `, ${over_noise.toFixed(2)} × noise` : "";
    said.push(`misfit ${about ? "≈ " : ""}${written(shownIn(y, rmse))} ${quantity(y).unit}${noise}`);
  }
  if (drawn < of) said.push(`drawn ${drawn} of ${of}`);
  over(pen, said.join("; "), place.width - RIGHT - 2, TOP - 7, theme.muted);
}
const levelOf = curve => columns.of[state.colour][curve.path.members[0]];
const colourOf = curve => palette[levelOf(curve)];
function endsOf(shown, lines) {
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
  return {x: roomy(x0, x1), y: roomy(y0, y1)};
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
function band(pen, curve, place) {
  const points = bandOf(curve), colour = colourOf(curve);
  if (points.length < 2) return;
  pen.globalAlpha = .13;
  pen.fillStyle = colour;
  pen.beginPath();
  for (const [x, low] of points) pen.lineTo(place.X(x), place.Y(low));
  for (const [x, , , high] of [...points].reverse()) pen.lineTo(place.X(x), place.Y(high));
  pen.fill();
  pen.globalAlpha = .8;
  stroke(pen, points.flatMap(([x, , middle]) => [x, middle]), place, colour, 1, [2, 2]);
  pen.globalAlpha = 1;
}
// By level of the colour, the curve of most points: it has a band and a label.
function typicalOf(lines) {
  const found = new Map();
  for (const line of lines) {
    const level = levelOf(line.curve), other = found.get(level);
    if (level >= 0 && (!other || other.curve.path.n < line.curve.path.n)) found.set(level, line);
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
export function nearest(panel, [x, y]) {
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
