// The pictures of a page: their frames, what pointer, fingers and keys do in them, zoom, and pictures as files. What
// they show comes from the part of the page that began, that of files or that of a project. It has
//   frame(panel, figure, caption, keys)  fills the frame of a new picture; sets panel.words, the texts of its axes
//   compute()  before pictures are drawn; and told() after that, recolour() after a change of the colours, if needed
//   scene(panel)  {name, box}: the name of what `still` draws, and the box of the axes
//   still, moving, above(pen, panel, place)  draw: kept while the name stays; anew each time; not cut at the axes
//   hover(panel, at), click(panel, at, event), choose(panel, box, event), key(panel, event)  `at` is null outside
//   kept(), csv(panel)  what the address keeps, and the numbers of a picture
import {RIGHT, axes, frameOf, onThemeChange, penOf, placeOf, readTheme, theme, whenPrinted} from "./axes.js";
import {byId, canvasOf, element, key} from "./dom.js";

const ZOOM = 1.25, NEAREST_DRAG = 6, GROWTH = 0.2;
export const panels = [];
export let dragging = false;  // while a slider moves
export const setDragging = moves => { dragging = moves; };
let part = null, pending = false;

export function begin(given) {
  part = given;
  byId("to-pictures").addEventListener("click", () => panels.length && panels[0].canvas.focus());
  for (const one of tools()) one.addEventListener("click", () => {
    const pressed = tool() !== one.id;
    for (const other of tools()) other.setAttribute("aria-pressed", pressed && other === one);
    byId("panels").classList.toggle("dragging", pressed);
  });
  new ResizeObserver(frame).observe(byId("panels"));  // also from nothing, as in a frame that is laid out later
  whenPrinted(retheme);
  onThemeChange(retheme);
}
export function retheme() {
  readTheme();
  part.recolour?.();
  frame();  // at once, as paper does not wait
}
export function update() {
  if (pending) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; frame(); });
}
export function frame() {
  part.compute();
  panels.forEach(draw);
  part.told?.();
}
export function remember() {
  if (location.protocol === "about:") return;  // a page in a notebook has no address
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(part.kept()))}`);
}
export function recalled() {
  try {
    return {...JSON.parse(decodeURIComponent(location.hash.slice(1)))};
  } catch {
    return {};
  }
}

// ---- drawing
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
  const scene = part.scene(panel), box = limits(panel, scene.box);
  const name = [width, height, ratio, ...box.x, ...box.y, theme.ink, scene.name].join();
  if (!panel.layer || panel.layer.name !== name) {
    const layer = canvasOf(Math.round(width * ratio), Math.round(height * ratio));
    const on = layer.getContext("2d"), place = placeOf(box, width, height, ratio);
    on.setTransform(ratio, 0, 0, ratio, 0, 0);
    axes(on, place);
    on.clip(frameOf(place));
    part.still(on, panel, place);
    panel.layer = {name, layer, place};
  }
  const place = panel.place = panel.layer.place;
  pen.drawImage(panel.layer.layer, 0, 0, width, height);
  pen.font = theme.font;
  pen.save();
  pen.clip(frameOf(place));
  part.moving(pen, panel, place);
  pen.restore();
  part.above?.(pen, panel, place);
}
function limits(panel, box) {
  if (panel.view) return panel.view;
  if (panel.box && dragging) {  // axes only grow while a slider moves, so that the curve is seen to move, and in steps
    const grown = axis => {
      const [low, high] = box[axis], [first, last] = panel.box[axis], step = GROWTH * (last - first);
      return [low < first ? low - step : first, high > last ? high + step : last];
    };
    box = {x: grown("x"), y: grown("y")};
  }
  return panel.box = box;
}
// While a slider moves, only pictures that are on the screen are drawn.
const seen = new IntersectionObserver(entries => {
  for (const entry of entries) {
    const panel = panels.find(one => one.canvas === entry.target);
    if (panel) panel.unseen = !entry.isIntersecting;
  }
});

// ---- a picture
export function addPanel(given) {
  const panel = {...given, canvas: element("canvas", "", "", {tabIndex: 0, role: "img"}),
    tip: element("div", "tip", "", {hidden: true})};
  panel.whole = key("whole", "shows all again (0, or a double click)", () => look(panel, null));
  panel.whole.hidden = true;
  const saves = [["picture (PNG)", savePicture],
    ["numbers (CSV)", () => saved(panel, "csv", new Blob([part.csv(panel)], {type: "text/csv"}))]];
  const more = element("details", "more", [element("summary", "", "⋯", {ariaLabel: "save this picture"}),
    element("div", "", saves.map(([word, save]) =>
      key(word, `save this ${word}`, () => { more.open = false; save(panel); })))]);
  const caption = element("figcaption"), plot = element("div", "plot", [panel.canvas, panel.tip]);
  const figure = element("figure", "panel", [caption, plot]);
  part.frame(panel, figure, caption, [panel.whole, more]);
  byId("panels").append(figure);
  gestures(panel, plot);
  seen.observe(panel.canvas);
  panels.push(panel);
}
export function removePanel(panel) {
  panels.splice(panels.indexOf(panel), 1);
  panel.canvas.closest("figure").remove();
  seen.unobserve(panel.canvas);
}
// What a drag in a picture does: a rectangle chooses points or becomes the view, or the picture is moved. Without a
// button of these pressed, that of a mouse chooses points, and a finger moves the page; two fingers zoom.
const tools = () => ["select", "zoom", "move"].map(byId).filter(Boolean);
export const tool = () => tools().find(one => one.ariaPressed === "true")?.id ?? "";
function gestures(panel, plot) {
  const canvas = panel.canvas, rectangle = plot.appendChild(element("div", "rectangle")), touches = new Map();
  let from = null, to = null, just = false;
  const at = event => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const end = () => { from = to = null; rectangle.hidden = true; };
  end();
  // the page stays
  canvas.addEventListener("touchstart", event => { if (event.touches.length > 1) event.preventDefault(); },
    {passive: false});
  canvas.addEventListener("pointerdown", event => {
    just = false;
    if (event.pointerType === "touch") touches.set(event.pointerId, at(event));
    if (touches.size > 1) return end();
    if (event.button === 0 && (part.choose || tool()) && (event.pointerType !== "touch" || tool())) from = at(event);
  });
  canvas.addEventListener("pointermove", event => {
    const now = at(event);
    if (touches.size === 2 && touches.has(event.pointerId)) {
      const [, other] = [...touches].find(([id]) => id !== event.pointerId), old = touches.get(event.pointerId);
      touches.set(event.pointerId, now);
      pan(panel, (now[0] - old[0]) / 2, (now[1] - old[1]) / 2);
      const apart = place => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), NEAREST_DRAG);
      return zoom(panel, apart(old) / apart(now), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
    }
    if (!to && (!from || Math.hypot(now[0] - from[0], now[1] - from[1]) < NEAREST_DRAG)) return part.hover(panel, now);
    if (!to) { canvas.setPointerCapture(event.pointerId); panel.tip.hidden = true; }
    if (tool() === "move") {
      const last = to || from;
      to = now;
      return pan(panel, now[0] - last[0], now[1] - last[1]);
    }
    to = now;
    rectangle.hidden = false;
    Object.assign(rectangle.style, {left: `${Math.min(from[0], to[0])}px`, top: `${Math.min(from[1], to[1])}px`,
      width: `${Math.abs(to[0] - from[0])}px`, height: `${Math.abs(to[1] - from[1])}px`});
  });
  const up = event => {
    touches.delete(event.pointerId);
    if (to && event.type === "pointerup" && tool() !== "move") {
      const {ox, oy, kx, ky} = panel.place, sorted = list => list.sort((a, b) => a - b);
      const box = {x: sorted([from[0], to[0]].map(place => (place - ox) / kx)),
        y: sorted([from[1], to[1]].map(place => (place - oy) / ky))};
      if (tool() === "zoom") look(panel, box); else part.choose(panel, box, event);
    }
    just = to !== null;
    end();
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => part.hover(panel, null));
  canvas.addEventListener("click", event => {
    if (just) just = false; else if (tool() !== "zoom") part.click(panel, at(event), event);
  });
  canvas.addEventListener("wheel", event => {
    if (!event.ctrlKey && tool() !== "zoom") return;  // the page scrolls
    event.preventDefault();
    zoom(panel, ZOOM ** Math.sign(event.deltaY), at(event));
  }, {passive: false});
  canvas.addEventListener("dblclick", () => look(panel, null));
  canvas.addEventListener("keydown", event => {
    const isPlain = !event.ctrlKey && !event.metaKey, drags = to !== null;
    if (event.key === "Escape") end();
    if (["+", "=", "-"].includes(event.key) && isPlain) zoom(panel, event.key === "-" ? ZOOM : 1 / ZOOM,
      [canvas.clientWidth / 2, canvas.clientHeight / 2]);
    else if (event.key === "0" && isPlain) look(panel, null);
    else if (!drags) part.key(panel, event);
  });
}

// ---- zoom, and pictures as files
const boxOf = panel => panel.view || panel.place.box;
// The view widened by a factor about a place of the picture, or shifted by pixels.
function zoom(panel, factor, [x, y]) {
  const {ox, oy, kx, ky} = panel.place, box = boxOf(panel),
    about = ([low, high], at) => [at + (low - at) * factor, at + (high - at) * factor];
  look(panel, {x: about(box.x, (x - ox) / kx), y: about(box.y, (y - oy) / ky)});
}
function pan(panel, dx, dy) {
  const {kx, ky} = panel.place, box = boxOf(panel);
  look(panel, {x: box.x.map(at => at - dx / kx), y: box.y.map(at => at - dy / ky)});
}
export function look(panel, view) {
  panel.view = view;
  panel.whole.hidden = !view;
  update();
}
function saved(panel, ending, content) {
  const name = `${document.title} ${panel.y} over ${panel.x}`.replace(/[^\w.-]+/g, "_");
  const link = element("a", "", "", {href: URL.createObjectURL(content), download: `${name}.${ending}`});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
function savePicture(panel) {
  const scale = 2, head = 26, foot = 18, {clientWidth: width, clientHeight: height} = panel.canvas;
  const canvas = canvasOf(scale * width, scale * (height + head + foot)), pen = canvas.getContext("2d");
  const inner = canvasOf(scale * width, scale * height), on = inner.getContext("2d");
  on.setTransform(scale, 0, 0, scale, 0, 0);
  paint(panel, on, width, height, scale);
  pen.fillStyle = theme.paper;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(inner, 0, scale * head);
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  Object.assign(pen, {font: theme.font.replace("11px", "12px"), fillStyle: theme.ink});
  pen.fillText(`${panel.words.y} — ${document.title}`, 8, 17);
  pen.textAlign = "right";
  pen.fillText(panel.words.x, width - RIGHT, height + head + foot - 5);
  canvas.toBlob(blob => saved(panel, "png", blob));
  update();
}
