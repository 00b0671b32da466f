// Filters of the points: a button for each group, which is the key of the colours too, and ranges.
import {byId, element, key} from "./dom.js";
import {axisKnown, columns, facet, filter, project, quantity, state, visible} from "./model.js";
import {remember, update} from "./pictures.js";
import {palette} from "./points.js";

export function listFacets() {
  byId("legend").replaceChildren();
  byId("facets").replaceChildren();
  const wide = project.points.facets.filter(one => one.as_range).map(one => one.name);
  for (const name of wide) delete state.hidden[name];
  for (const one of project.points.facets.filter(facet => facet.labels.length > 1 && !facet.as_range)) {
    const home = byId(one.name === state.colour ? "legend" : "facets"),
      present = one.labels.filter((_, k) => one.of.includes(k));
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
    line.append(element("span", "word", quantity(name).word), "from ", ends[0], " to ", ends[1],
      ` ${quantity(name).unit}`);
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
export function showFacets() {
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
