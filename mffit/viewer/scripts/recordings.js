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
const does = byId("choice").dataset.does, adds = does === "add";
function choice() {
  return adds ? {groups: table.groups, seen: table.seen} : {
    tyre: {name: text("name"), size: text("size") || null, unloaded_radius: number("unloaded_radius"),
      nominal_load: number("nominal_load"), nominal_pressure: number("nominal_pressure"),
      nominal_speed: number("nominal_speed"), width: number("width"), rim_radius: number("rim_radius"),
      side: text("side")},
    rig: {type: text("type"), axes: text("axes"), path_radius: number("path_radius"),
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
  if (!refusals.length) return;
  say(`${refusals.length} of ${count} files were not stored; see below.`, true);
  list([...refusals, ...table.problems]);
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
const touched = new Set();  // fields that were filled in by hand
byId("choice").addEventListener("input", event => touched.add(event.target.name));
async function load() {
  const found = await read("recordings");
  if (!found || found.error) return say(found ? found.error : ENDED, true);
  const typed = table && table.groups.length ? choice() : null;
  table = table ? carriedOver(table, found) : found;
  show();
  if (!typed || adds) return;
  for (const [name, x] of Object.entries({...typed.tyre, ...typed.rig})) {
    if (x !== null && touched.has(name)) document.querySelector(`[name=${name}]`).value = x;
  }
  document.querySelector("[name=type]").dispatchEvent(new Event("change"));
}

function show() {
  const tyre = byId("tyre"), rig = byId("rig"), disc = table.disc.length > 0;
  tyre.replaceChildren();
  rig.replaceChildren();
  byId("found").hidden = true;
  byId("choice").hidden = !table.groups.length;
  list(table.problems);
  if (!table.groups.length) return say(table.problems.length ? "None of the recordings here can be read; see below."
    : adds ? "Every recording of this folder is in tyre.toml." : "No recordings here yet.", table.problems.length > 0);
  if (!adds) tyreAndRig(tyre, rig, disc);
  byId("groups").replaceChildren(...table.groups.map(group));
  const first = disc && !adds ? `These look like recordings of a disc: ${table.disc.join("; ")}.` : "";
  say(first || (table.problems.length ? "Something was not recognised; see below." : ""),
    !first && table.problems.length > 0);
}
function tyreAndRig(tyre, rig, disc) {
  field(tyre, "name", "name", {value: table.tyre.name, required: true});
  field(tyre, "size", "size", {value: table.tyre.size ?? "", placeholder: "optional"});
  const any = {type: "number", step: "any", required: true, min: 0};
  field(tyre, "unloaded radius [m]", "unloaded_radius", any);
  field(tyre, "nominal load [N]", "nominal_load", any);
  field(tyre, "nominal pressure [kPa]", "nominal_pressure", {...any, value: table.tyre.nominal_pressure ?? ""});
  const optional = {type: "number", step: "any", min: 0, placeholder: "optional"};
  for (const [word, name] of [["nominal speed [m/s]", "nominal_speed"], ["width [m]", "width"],
    ["rim radius [m]", "rim_radius"]])
    field(tyre, word, name, {...optional, value: table.tyre[name] ?? ""});
  select(tyre, "side of the measured tyre", "side", ["left", "right", "symmetric"].map(x => [x, x]), "left");
  const type = select(rig, "rig", "type", [["", "disc or belt?"], ["flat-track", "belt: a straight path"],
    ["rotating-disk", "disc: a curved path"]], disc ? "" : "flat-track");
  type.required = true;
  select(rig, "axes of the readings", "axes", ["iso", "sae",
    "adapted-sae"].map(x => [x, table.axes.includes(x) ? `${x} (agrees with the signs)` : x]), table.axes[0] || "iso");
  const radius = field(rig, "path radius [m]", "path_radius", {...optional, placeholder: ""});
  const centre = select(rig, "disc centre, seen rolling forwards", "path_centre", ["left", "right"].map(x => [x, x]),
    "left");
  const curved = () => {
    radius.required = type.value === "rotating-disk";
    for (const one of [radius, centre]) one.parentNode.hidden = one.disabled = !radius.required;
  };
  type.addEventListener("change", curved);
  curved();
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
    ...one.remarks.map(remark => element("p", "sub", remark))]);
}
function row(column) {
  const names = ["", ...table.channels.map(one => one.name)];
  const is = element("select", "", names.map(name => new Option(name || "not used", name)),
    {ariaLabel: `${column.heading} is`, value: column.channel || ""});
  const unit = element("input", "", "", {value: column.unit, placeholder: "as stated", size: 8,
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
