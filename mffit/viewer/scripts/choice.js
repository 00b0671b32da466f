// Points that are pointed at and chosen, in a picture or by keys, and the list of what was read at them.
import {RESIDUAL, inOrder, within} from "./curves.js";
import {byId, element, key, showTip} from "./dom.js";
import {axisKnown, channels, columns, hooks, left, own, project, quantity, shownIn, whyLeftOut} from "./model.js";
import {tool, update} from "./pictures.js";
import {MOST_LISTED, chosen, isChosen, label, nearest, pointed, setChosen, setPointed} from "./points.js";
import {labelled, symbol, trimmed, unitOf, written} from "./text.js";

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
export function select(members) {
  setChosen(members);
  showChosen();
  update();
}
export function choose(i, add) {
  if (i < 0) select(add ? chosen : []);
  else if (add) select(isChosen[i] ? chosen.filter(k => k !== i) : [...chosen, i]);
  else select([i]);
}
export function chooseAll(members, add) {
  select(add ? chosen.concat([...members].filter(i => !isChosen[i])) : [...members]);
}
export function showChosen() {
  byId("chosen").hidden = !chosen.length;
  byId("chosen-title").textContent = chosen.length === 1 ? pointName(chosen[0]) : chosen.length
    ? `${chosen.length} points` : "";
  if (!chosen.length) return;
  const shown = chosen.slice(0, MOST_LISTED), body = byId("chosen-table").tBodies[0];
  const row = cells => element("tr", "", cells), cell = text => element("td", "n", text);
  const short = (name, before = "") => [before, symbol(quantity(name)), " ", element("br"), unitOf(quantity(name))];
  const named = Object.keys(project.quantities).filter(name => columns[name] &&
    shown.some(i => Number.isFinite(columns[name][i]) && columns[name][i] !== 0));
  const about = [
    ...channels.map(name => [label(RESIDUAL + name), i => written(shownIn(name, columns[name][i] - own[name][i])),
      short(name, "residual ")]),
    ...named.filter(name => chosen.length === 1 || axisKnown(name)).map(name =>
      [label(name), i => trimmed(written(shownIn(name, (columns.read[name] || columns[name])[i]))), short(name)]),
    ...(shown.some(i => left[i]) ? [["left out", i => left[i] ? whyLeftOut(i) || "yes" : "", "left out"]] : []),
  ];
  byId("chosen-table").tHead.replaceChildren(...chosen.length === 1 ? [] : [row([element("th", "", "point"),
    ...about.map(([title, , head]) => element("th", "n", head, {title})), element("th")])]);
  if (chosen.length === 1) {
    body.replaceChildren(...about.map(([title, text]) => row([element("th", "", title), cell(text(chosen[0]))])));
  } else {
    body.replaceChildren(...shown.map(i => row([element("td", "", pointName(i)), ...about.map(([, text]) =>
      cell(text(i))), cell([unchoose(i)])])));
    if (shown.length < chosen.length) body.append(row([cell(`and ${chosen.length - shown.length} more`)]));
  }
  labelled(byId("chosen-table"));
  byId("chosen-actions").replaceChildren(...hooks.chosenActions(),
    key("Choose none", "ends the choice (Esc in a picture)", () => choose(-1, false)));
}
const unchoose = i => Object.assign(key("×", "take this point out of the choice", () => choose(i, true)),
  {ariaLabel: `take ${pointName(i)} out of the choice`});
function step(panel, by, add) {
  const order = inOrder(panel.kept);
  if (!order.length) return;
  const at = order.indexOf(chosen[chosen.length - 1]);
  const next = order[((at < 0 && by < 0 ? 0 : at) + by + order.length) % order.length];
  if (add && isChosen[next]) select(chosen.slice(0, -1));  // back over the points that were added
  else chooseAll([next], add);
  tip(panel, next);
}

// What pointer and keys do in a picture.
export const pointing = {
  hover(panel, at) {
    const i = at ? nearest(panel, at) : -1;
    tip(panel, i);
    if (i === pointed) return;
    setPointed(i);
    update();
  },
  click: (panel, at, event) => choose(nearest(panel, at), event.shiftKey || tool() === "select"),
  choose: (panel, {x, y}, event) => chooseAll(within(panel.kept, ...x, ...y), event.shiftKey || tool() === "select"),
  key(panel, event) {
    const steps = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (steps) { event.preventDefault(); step(panel, steps, event.shiftKey); }
    else if (event.key === "Escape") { choose(-1, false); tip(panel, -1); }
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "a") {
      event.preventDefault();
      chooseAll(inOrder(panel.kept), false);
    }
    else if (event.key === "Delete" && chosen.length) hooks.leaveOut();
  },
};
