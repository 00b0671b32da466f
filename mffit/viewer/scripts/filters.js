// Filters of the points: a button for each group, which is the key of the colours too, and ranges.
import {byId, element, key, numberField} from "./dom.js";
import {axisKnown, columns, facet, filter, project, quantity, state, visible} from "./model.js";
import {remember, update} from "./pictures.js";
import {palette} from "./points.js";

export function listFacets() {
  byId("legend").replaceChildren();
  byId("facets").replaceChildren();
  const wide = project.points.facets.filter(one => one.as_range).map(one => one.name);
  for (const name of wide) delete state.hidden[name];
  for (const one of project.points.facets.filter(facet => facet.labels.length > 1 && !facet.as_range)) {
    const present = one.labels.filter((_, k) => one.of.includes(k));
    if (present.length < 2) continue;
    const all = key("all", "show all", () => { delete state.hidden[one.name]; refilter(); }, "small chip");
    byId(one.name === state.colour ? "legend" : "facets").append(element("div", "facet",
      [element("span", "word", one.word), all, ...present.map(text => chip(one, text))]));
  }
  for (const name of [...wide, "T", "t"].filter(axisKnown)) {
    const {word, unit} = quantity(name), [from, to] = [0, 1].map(k => numberField({
      ariaLabel: `${word} ${k ? "to" : "from"}`, value: state.ranges[name]?.[k] ?? "",
      onchange: ({target: {valueAsNumber: x}}) => {
        (state.ranges[name] ??= [null, null])[k] = Number.isFinite(x) ? x : null;
        refilter();
      },
    }));
    byId("facets").append(element("div", "facet range",
      [element("span", "word", word), "from ", from, " to ", to, ` ${unit}`]));
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
  }, "small chip");
  made.ondblclick = alone;
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
export function showFacets() {
  for (const made of document.querySelectorAll(".facet .chip[data-facet]")) {
    const {facet: name, label: text} = made.dataset;
    made.setAttribute("aria-pressed", !(state.hidden[name] || []).includes(text));
    made.textContent = text;
    if (name !== state.colour) continue;
    made.prepend(element("i"));
    made.firstChild.style.background = palette[facet(name).labels.indexOf(text)];
  }
  const count = visible.reduce((sum, one) => sum + one, 0);
  byId("shown").textContent = `${count} of ${columns.count}`;
}
