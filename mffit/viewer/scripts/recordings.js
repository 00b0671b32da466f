// The recordings of a folder: what is recognised, corrected by hand, and the project made of them.
import {ENDED, asked, listen, sent, takesRecordings} from "./calls.js";
import {byId, element} from "./dom.js";

let table = null;
const say = (sentence, bad = false) => {
  byId("status").textContent = sentence;
  byId("status").classList.toggle("bad", bad);
};
function field(home, word, name, given) {
  const input = element("input", "", "", {name, ...given});
  home.append(element("label", "", [word, input]));
  return input;
}
function select(home, word, name, options, value) {
  const list = element("select", "", options.map(([text, shown]) => new Option(shown, text)), {name, value});
  home.append(element("label", "", [word, list]));
  return list;
}
// A question for which the recordings are read; meanwhile it can be stopped.
async function read(address, given) {
  byId("stop").hidden = false;
  const found = await asked(address, () => say("reading the recordings; this takes a while"), given);
  byId("stop").hidden = true;
  return found;
}
byId("stop").addEventListener("click", () => asked("stop-reading", say, sent({})));
async function post(address) {
  const found = await read(address, sent(choice()));
  if (!found || found.error) say(found ? found.error : ENDED, true);
  return found && !found.error ? found : null;
}
const number = name => {
  const x = document.querySelector(`[name=${name}]`).valueAsNumber;
  return Number.isFinite(x) ? x : null;
};
const text = name => document.querySelector(`[name=${name}]`).value;
const touched = new Set();  // fields of tyre and rig that were filled in by hand
const proposed = {};  // what the page wrote into the others, which is nobody's choice
const byHand = input => touched.has(input.name) || input.value !== (proposed[input.name] ?? "");
const chosen = name => byHand(document.querySelector(`[name=${name}]`)) ? text(name) : "";
const does = byId("choice").dataset.does, adds = does === "add";
function choice() {
  return adds ? {groups: table.groups, seen: table.seen} : {
    tyre: {name: text("name"), size: text("size") || null, unloaded_radius: number("unloaded_radius"),
      nominal_load: number("nominal_load"), nominal_pressure: number("nominal_pressure"),
      nominal_speed: number("nominal_speed"), width: number("width"), rim_radius: number("rim_radius"),
      side: text("side")},
    rig: {type: chosen("type"), axes: chosen("axes"), path_radius: number("path_radius"),
      path_centre: text("path_centre")},
    groups: table.groups,
  };
}
function list(sentences) {
  byId("problems").replaceChildren(...sentences.map(sentence => element("li", "", sentence)));
  byId("problems").hidden = !sentences.length;
}
const offer = takesRecordings(say, async (refusals, count) => {
  say("reading the recordings");
  await load();
  if (refusals.length) say(`Not stored, ${refusals.length} of ${count}: ${refusals.join("; ")}`, true);
});
for (const id of ["add-files", "add-folder"]) byId(id).addEventListener("change",
  event => { offer([...event.target.files]); event.target.value = ""; });
// What was corrected stays when recordings are added.
function carriedOver(before, after) {
  const columns = new Map(
    before.groups.flatMap(group => group.columns).map(one => [`${one.heading} ${one.stated}`, one]));
  const files = new Map(before.groups.flatMap(group => group.files).map(one => [one.name, one]));
  for (const group of after.groups) {
    for (const one of group.columns) {
      const {channel, unit, minus} = columns.get(`${one.heading} ${one.stated}`) || one;
      Object.assign(one, {channel, unit, minus});
    }
    for (const one of group.files) {
      const {used, backward} = files.get(one.name) || one;
      Object.assign(one, {used, backward});
    }
  }
  return after;
}
byId("choice").addEventListener("input", event => { touched.add(event.target.name); byId("found").hidden = true; });
async function load() {
  const found = await read("recordings");
  if (!found || found.error) return say(found ? found.error : ENDED, true);
  const before = table;
  table = before ? carriedOver(before, found) : found;
  byId("choice").hidden = !table.groups.length;
  byId("groups").replaceChildren(...table.groups.map(group));
  if (!adds && !byId("tyre").childElementCount) tyreAndRig(byId("tyre"), byId("rig"));
  show();
  if (before && table.groups.length) await recognise();
}
let asking = 0;
// What the files that are ticked say, with the columns as they are chosen now.
async function recognise() {
  const asks = ++asking, found = await read("recognised", sent(choice()));
  if (asks !== asking) return;
  if (!found || found.error) return say(found ? found.error : ENDED, true);
  Object.assign(table, found);
  show();
}
byId("groups").addEventListener("change", recognise);

function show() {
  const problems = [...table.unreadable, ...table.problems];
  byId("found").hidden = true;
  list(problems);
  if (!table.groups.length) return say(problems.length ? "None of the recordings here can be read; see below."
    : adds ? "Every recording of this folder is in tyre.toml." : "No recordings here yet.", problems.length > 0);
  for (const [k, home] of document.querySelectorAll(".remarks").entries())
    home.replaceChildren(...(table.remarks[k] ?? []).map(remark => element("p", "sub", remark)));
  if (!adds) propose();
  if (!table.known) return say("These recordings do not say yet what rig and axes they are of; see below.", true);
  const disc = table.disc.length && !adds ? `These look like recordings of a disc: ${table.disc.join("; ")}.` : "";
  say(disc || (problems.length ? "Something was not recognised; see below." : ""), !disc && problems.length > 0);
}
// The fields that nobody filled in have what the recordings say; those of which they say nothing are empty.
function propose() {
  const {known, disc, axes, tyre} = table;
  for (const option of document.querySelector("[name=axes]").options)
    option.text =
      axes.includes(option.value) ? `${option.value} (agrees with the signs)` : option.value || "which axes?";
  const said = {...tyre, type: known && !disc.length ? "flat-track" : "", axes: axes[0]};
  for (const input of document.querySelectorAll("#tyre [name], #rig [name]"))
    if (!byHand(input) && input.name !== "side") {
      input.value = said[input.name] ?? "";
      proposed[input.name] = input.value;
    }
  document.querySelector("[name=type]").dispatchEvent(new Event("change"));
}
function tyreAndRig(tyre, rig) {
  field(tyre, "name", "name", {required: true});
  field(tyre, "size", "size", {placeholder: "optional"});
  const any = {type: "number", step: "any", required: true, min: 0};
  field(tyre, "unloaded radius [m]", "unloaded_radius", any);
  field(tyre, "nominal load [N]", "nominal_load", any);
  field(tyre, "nominal pressure [kPa]", "nominal_pressure", any);
  const optional = {type: "number", step: "any", min: 0, placeholder: "optional"};
  for (const [word, name] of [["nominal speed [m/s]", "nominal_speed"], ["width [m]", "width"],
    ["rim radius [m]", "rim_radius"]])
    field(tyre, word, name, optional);
  select(tyre, "side of the measured tyre", "side", ["left", "right", "symmetric"].map(x => [x, x]), "left");
  const type = select(rig, "rig", "type", [["", "disc or belt?"], ["flat-track", "belt: a straight path"],
    ["rotating-disk", "disc: a curved path"]], "");
  const axes = select(rig, "axes of the readings", "axes", ["", "iso", "sae", "adapted-sae"].map(x => [x, x]), "");
  const radius = field(rig, "path radius [m]", "path_radius", {...optional, placeholder: ""});
  const centre = select(rig, "disc centre, seen rolling forwards", "path_centre", [["", "left or right?"],
    ["left", "left"], ["right", "right"]], "");
  const curved = () => {
    const disc = type.value === "rotating-disk";
    for (const one of [radius, centre]) { one.required = disc; one.parentNode.hidden = one.disabled = !disc; }
  };
  type.required = axes.required = true;
  type.addEventListener("change", curved);
}
const checkbox = (checked, given) => element("input", "", "", {type: "checkbox", checked, ...given});
function group(one) {
  const names = one.files.map(file => file.name), title = names.length > 3
    ? `${names[0]} ... ${names[names.length - 1]} (${names.length} files)` : names.join(", ");
  const files = one.files.map(file => element("div", "", [
    element("label", "", [
      checkbox(file.used !== false, {onchange: event => { file.used = event.target.checked; }}),
      `${file.name}, ${file.rows} row${file.rows === 1 ? "" : "s"} `]), " ",
    element("label", "", [
      checkbox(file.backward, {onchange: event => { file.backward = event.target.checked; }}), "rolls backwards"])]));
  const words = ["heading", "unit in the file", "readings", "is", "read in unit", "turn sign", ""];
  const head = element("tr", "", words.map(word => element("th", "", word)));
  return element("section", "", [element("h2", "", title),
    element("details", "", [element("summary", "", "files"), element("div", "files", files)],
      {open: names.length < 4}),
    element("div", "scroll", [element("table", "", [element("tbody", "", [head, ...one.columns.map(row)])])]),
    element("div", "remarks")]);
}
function row(column) {
  const names = ["", ...table.channels.map(one => one.name)];
  const is = element("select", "", names.map(name => new Option(name || "not used", name)),
    {ariaLabel: `${column.heading} is`, value: column.channel || ""});
  const unit = element("input", "", "", {value: column.unit, size: 8,
    placeholder: column.stated ? "as stated" : "not stated",
    ariaLabel: `unit of ${column.heading}`, onchange: () => { column.unit = unit.value.trim(); }});
  const minus = checkbox(column.minus, {ariaLabel: `turn the sign of ${column.heading}`,
    onchange: () => { column.minus = minus.checked; }});
  const range = column.range ? column.range.map(x => Number(x.toPrecision(4))).join(" to ") : "text";
  const line = element("tr", "", [column.heading, column.stated, range, is, unit, minus, column.why].map((inside, k) =>
    element("td", k === 6 ? "why" : "", [inside])));
  const about = () => {
    is.title = table.channels.find(one => one.name === is.value)?.about ?? "";
    line.classList.toggle("unused", !is.value);
  };
  is.onchange = () => { column.channel = is.value; about(); };
  about();
  return line;
}
byId("check").addEventListener("click", async () => {
  if (!byId("choice").reportValidity()) return;
  say("reading the recordings as chosen");
  byId("found").hidden = true;
  const found = await post("check");
  if (!found) return;
  const said = [`${found.points} points`,
    ...found.conditions.map(one => `${one.word}: ${one.labels.join(", ")}`),
    found.axes.length ? `the signs agree with ${found.axes.join(" and ")} axes`
      : `the signs agree with no axes: in those chosen ${found.wrong.join(" and ")}`, ...found.warnings];
  byId("conditions").replaceChildren(...said.map(one => element("li", "", one)));
  byId("found").hidden = false;
  say("Checked; see below.");
});
byId("choice").addEventListener("submit", async event => {
  event.preventDefault();
  if (await post(does)) location.assign("./");
});
listen(state => { if (state === null) say(ENDED, true); });
load();
