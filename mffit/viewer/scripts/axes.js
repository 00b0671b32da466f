// A picture with axes on a canvas: its place for numbers, grid and ticks, curves, and texts over them.
export const RIGHT = 10, TOP = 18, BOTTOM = 22, LETTER = 6.6;
const RATIO_OF_PAPER = 3, EDGE = 3, FOLD = 58, DIGIT = 8;
export let theme = {};

// On paper pictures have the size, the colours and the sharpness of paper: CSS knows them by the class "paper".
const onPaper = () => document.documentElement.classList.contains("paper");
export function whenPrinted(draw) {
  for (const event of ["beforeprint", "afterprint"]) addEventListener(event, () => {
    document.documentElement.classList.toggle("paper", event === "beforeprint");
    draw();
  });
}
export function onThemeChange(draw) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}
export function readTheme() {
  const style = getComputedStyle(document.documentElement), of = name => style.getPropertyValue(`--${name}`).trim();
  theme = Object.fromEntries(["paper", "ink", "muted", "grid", "line", "accent"].map(name => [name, of(name)]));
  theme.dark = !onPaper() && matchMedia("(prefers-color-scheme: dark)").matches;
  theme.colours = [0, 1, 2, 3, 4, 5, 6, 7].map(i => of(`c${i}`));
  theme.font = `11px ${getComputedStyle(document.body).fontFamily}`;
}
function ticks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 2.5, 5, 10].find(n => n * power >= raw * (1 - 1e-9));
  const found = [], places = -Math.floor(Math.log10(step) + 1e-9) + (Math.abs(step / power - 2.5) < 1e-9 ? 1 : 0);
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  const digits = Math.max(0, Math.min(8, places));
  return found.map(x => ({x, text: (Math.abs(x) < step / 2 ? 0 : x).toFixed(digits).replace("-", "−")}));
}
// Limits with some room.
export function roomy(low, high) {
  const room = high - low > 1e-12 ? 0.03 * (high - low) : 1;
  return [low - room, high + room];
}
// The pen of a canvas that has the sharpness of screen or paper, cleared.
export function penOf(canvas, width, height) {
  const ratio = onPaper() ? RATIO_OF_PAPER : devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return {pen, ratio};
}
// Where the numbers of a box {x: [low, high], y: [low, high]} lie in a picture.
export function placeOf(box, width, height, ratio) {
  const rows = ticks(...box.y, 6), start = 10 + LETTER * Math.max(...rows.map(tick => tick.text.length));
  const columns = ticks(...box.x, Math.max(3, Math.min(8, (width - start) / FOLD)));
  const kx = (width - start - RIGHT) / (box.x[1] - box.x[0]), ky = (TOP + BOTTOM - height) / (box.y[1] - box.y[0]);
  const ox = start - box.x[0] * kx, oy = height - BOTTOM - box.y[0] * ky;
  const X = x => ox + kx * x, Y = y => oy + ky * y;
  return {box, start, width, height, ratio, rows, columns, kx, ky, ox, oy, X, Y};
}
// The part of the picture within its axes, and a little more.
export function frameOf({start, width, height}) {
  const frame = new Path2D();
  frame.rect(start - EDGE, TOP - EDGE, width - start - RIGHT + 2 * EDGE, height - TOP - BOTTOM + 2 * EDGE);
  return frame;
}
export function straight(pen, x1, y1, x2, y2, colour, dash = []) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1;
  pen.setLineDash(dash);
  pen.beginPath();
  pen.moveTo(Math.round(x1) + .5, Math.round(y1) + .5);
  pen.lineTo(Math.round(x2) + .5, Math.round(y2) + .5);
  pen.stroke();
  pen.setLineDash([]);
}
// Grid, ticks and their numbers; `place.texts` has where those are: [left, top, right, bottom, text].
export function axes(pen, place) {
  const {X, Y, box, start, width, height, rows, columns} = place, end = width - RIGHT, floor = height - BOTTOM;
  place.texts = [];
  const say = (text, x, y, align) => {
    const long = pen.measureText(text).width, left = align === "right" ? x - long : x - long / 2;
    pen.textAlign = align;
    pen.fillText(text, x, y);
    place.texts.push([left, y - DIGIT, left + long, y, text]);
  };
  pen.font = theme.font;
  pen.fillStyle = theme.muted;
  for (const tick of rows) {
    straight(pen, start, Y(tick.x), end, Y(tick.x), theme.grid);
    say(tick.text, start - 5, Y(tick.x) + 4, "right");
  }
  for (const tick of columns) {
    straight(pen, X(tick.x), TOP, X(tick.x), floor, theme.grid);
    say(tick.text, Math.min(X(tick.x), width - pen.measureText(tick.text).width / 2), height - 6, "center");
  }
  if (box.x[0] <= 0 && box.x[1] >= 0) straight(pen, X(0), TOP, X(0), floor, theme.line);
  if (box.y[0] <= 0 && box.y[1] >= 0) straight(pen, start, Y(0), end, Y(0), theme.muted);
}
// A line through x0, y0, x1, y1, ... with gaps where a number is none.
export function stroke(pen, points, {X, Y}, colour, width, dash) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.beginPath();
  let open = false;
  for (let k = 0; k < points.length; k += 2) {
    if (!Number.isFinite(points[k + 1])) { open = false; continue; }
    if (open) pen.lineTo(X(points[k]), Y(points[k + 1])); else pen.moveTo(X(points[k]), Y(points[k + 1]));
    open = true;
  }
  pen.stroke();
  pen.setLineDash([]);
}
export function ring(pen, x, y, r, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.stroke();
}
export function disc(pen, x, y, r, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.fill();
  ring(pen, x, y, r, theme.paper, 1.5);
}
export function over(pen, text, x, y, colour) {  // readable over curves
  Object.assign(pen,
    {fillStyle: colour, strokeStyle: theme.paper, lineWidth: 4, lineJoin: "round", textAlign: "right"});
  pen.strokeText(text, x, y);
  pen.fillText(text, x, y);
}
