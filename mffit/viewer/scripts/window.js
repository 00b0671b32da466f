// A local window: every click is saved in tyre.toml, and Refit runs the real fit.
import {ENDED, alive, asked, hasEnded, listen, sent, takesRecordings} from "./calls.js";
import {pointName, showChosen} from "./choice.js";
import {cells, dropMoves, moves, showRow, tryOut} from "./coefficients.js";
import {content} from "./content.js";
import {byId, details, element, key, numberField} from "./dom.js";
import {hooks, left, lineRanges, markLeftOut, project, rows, setTrial, trial} from "./model.js";
import {frame, remember, update} from "./pictures.js";
import {chosen} from "./points.js";
import {beginProject, showProject} from "./project.js";

let live = content.window, shownFit = content.project ? live.fits : -1, fetching = false,
  waiting = Promise.resolve();

const say = (sentence, bad = false) => {
  byId("status").textContent = sentence;
  byId("status").classList.toggle("bad", bad);
};
async function post(address, body = {}, refused = found => say(found.error, true)) {
  const found = await asked(address, say, sent(body));
  if (!found) return showStatus();
  if (found.state) setLive(found.state);
  if (found.error) refused(found);
  return !found.error;
}
// One change after the other: each is meant for the file as the one before left it. A refusal is said at the place of
// the click.
function edit(name, given, refused = found => say(found.error, true)) {
  const change = async () => {
    const done = await post("edit", {do: name, seen: live.digest, with: given},
      found => found.versions ? showBoth(found.versions) : refused(found));
    if (done) moves.push({edit: true});
    if (project) frame();
    return done;
  };
  const showBoth = versions => {
    const dialog = byId("both");
    for (const [whose, lines] of Object.entries(versions)) byId(`both-${whose}`).textContent = lines || "nothing";
    dialog.returnValue = "";
    dialog.onclose = () => { if (dialog.returnValue === "yes") waiting = waiting.then(change); };
    dialog.showModal();
  };
  return waiting = waiting.then(change);
}
hooks.canUndo = () => live.can_undo && !hasEnded();
hooks.undoEdit = () => { waiting = waiting.then(() => live.can_undo ? post("undo") : false); };
const entryOf = hooks.entryOf = name => live.hand[name] ?? null;

const drafts = {};  // by coefficient, what is typed into its limits and not saved yet
hooks.extendRow = (row, keys, box) => {
  const held = entry => typeof entry === "number" || entry === "base";
  const now = () => Number((row.name in trial ? trial[row.name] : row.value).toPrecision(9));
  const problem = element("p", "problem", "", {role: "alert"});
  let refusedAt = "";  // tyre.toml that a change was meant for
  const refused = found => {
    const [table, name, field = ""] = (found.key || "").split(".");
    const own = table === "coefficients" && name === row.name;
    problem.textContent = own ? `${field || name}: ${found.sentence}` : found.error;
    refusedAt = live.digest;
    for (const input of box.querySelectorAll(".limits input")) input.setAttribute("aria-invalid",
      input.name === field);
  };
  const change = entry => { problem.textContent = ""; return edit("coefficient", {name: row.name, entry}, refused); };
  const given = () => { const own = entryOf(row.name); return own !== null && typeof own === "object" ? own : {}; };
  const hold = key("hold", "write this value into tyre.toml: the fit takes it as exact", () => change(now()));
  const start = key("start", "write this value into tyre.toml as the one from which the fit starts",
    () => change({...given(), start: now()}));
  const free = key("free", "remove the entry of this coefficient from tyre.toml", () => change(null));
  const limits = key("limits", "bounds, start and what is known beforehand, written into tyre.toml", () => {
    if (row.name in drafts) delete drafts[row.name];
      else drafts[row.name] = typeof entryOf(row.name) === "object" ? {...entryOf(row.name)} : {};
    form();
  });
  const form = () => {
    limits.setAttribute("aria-expanded", row.name in drafts);
    const old = box.querySelector(".limits"), made = row.name in drafts
      ? limitsForm(row, change, refused, () => { delete drafts[row.name]; form(); limits.focus(); }) : null;
    if (old) old.remove();
    if (!made) { problem.textContent = ""; return; }
    problem.before(made);
    made.querySelector("input").focus();
  };
  keys.prepend(...[hold, start, limits, free].map(alive));
  box.append(problem);
  if (row.name in drafts) form();
  keys.refresh = () => {
    const entry = entryOf(row.name);
    if (live.digest !== refusedAt) problem.textContent = "";
    free.hidden = entry === null;
    limits.hidden = !row.may_be_free;
    start.hidden = !row.may_be_free || !["fitted", "regularised"].includes(row.status) || held(entry);
  };
  keys.refresh();
};
// Fields for the table of a coefficient; empty ones are not written.
function limitsForm(row, change, refused, close) {
  const draft = drafts[row.name];
  const [low, high] = row.bounds.map(x => x === null ? "none" : `${Number(x.toPrecision(5))}`);
  const fields = Object.entries({min: ["min", low], max: ["max", high], start: ["start", "chosen"],
    value: ["known value", "none"], u: ["its u (1 sigma)", "none"]}).map(([name, [word, placeholder]]) => {
    const field = numberField({name, placeholder, value: draft[name] ?? "", ariaLabel: `${row.name}: ${name}`,
      oninput: () =>
        { if (Number.isFinite(field.valueAsNumber)) draft[name] = field.valueAsNumber; else delete draft[name]; }});
    return element("label", "", [word, field]);
  });
  const save = alive(element("button", "small", "save", {type: "submit"}));
  const form = element("form", "limits", [...fields, save, key("cancel", "close without saving", close)], {
    noValidate: true, onkeydown: event => { if (event.key === "Escape") { event.stopPropagation(); close(); } }});
  form.addEventListener("submit", async event => {
    event.preventDefault();
    const wrong = [...form.querySelectorAll("input")].find(input => input.validity.badInput);
    if (wrong) return refused({key: `coefficients.${row.name}.${wrong.name}`,
      sentence: "this is not a number; write one, with a decimal point"});
    if (await change({...draft})) close();
  });
  return form;
}
byId("other").addEventListener("click", () => byId("other-file").click());
byId("other-file").addEventListener("change", async event => {
  const [file] = event.target.files;
  event.target.value = "";
  if (!file || !project) return;
  const found = await asked("values", say, sent({name: file.name, text: await file.text()}));
  if (!found) return showStatus();
  if (found.error) return say(found.error, true);
  tryOut(found.values);
  say(`Solid curves have the values of ${file.name}, dashed ones are the fit; Reset all ends it.`);
});
const leaveOut = hooks.leaveOut = () => {
  const members = chosen.filter(i => !left[i]), dialog = byId("ask");
  if (!members.length || hasEnded()) return;
  byId("ask-about").textContent = members.length === 1 ? `${pointName(members[0])} gets no weight in the fit.`
    : `${members.length} points get no weight in the fit.`;
  dialog.returnValue = "";
  dialog.onclose = () => {
    const why = byId("ask-why").value.trim();
    if (dialog.returnValue === "yes" && why) edit("leave_out", {readings: lineRanges(members), why});
  };
  dialog.showModal();
  byId("ask-why").select();
};
hooks.chosenActions = () => [
  ...chosen.some(i => !left[i])
    ? [key("Leave out", "asks why, and writes it into tyre.toml (Delete)", leaveOut)] : [],
  ...chosen.some(i => left[i]) ? [key("Take back", "removes it from [fit] exclude of tyre.toml",
    () => edit("take_back", {readings: lineRanges(chosen.filter(i => left[i]))}))] : [],
].map(alive);

function setLive(state) {
  live = state;
  showSettings();
  if (!live.can_undo) dropMoves(one => !one.trial);  // another program has changed the file since
  if (live.fits !== shownFit && (live.fits > 0 || live.has_readings)) {
    showStatus();
    return bring();
  }
  if (project) {
    project.hand = live.hand;
    project.exclude = live.exclude;
    markLeftOut(live.exclude);
    rows.forEach(showRow);
    for (const name in cells) cells[name].keys.refresh();
    showChosen();
    update();
  }
  showStatus();
}
async function bring() {
  if (fetching) return;
  fetching = true;
  const wantedFit = live.fits, data = await asked("project", say);
  fetching = false;
  if (!data || data.error) return showStatus();
  if (project && (data.turn_slip !== project.turn_slip || data.star !== project.star)) return location.reload();
  if (shownFit > 0) {  // a new fit: what the sliders tried is over
    setTrial({});
    dropMoves(one => one.trial);
    remember();
  }
  shownFit = wantedFit;
  await showProject(data);
  setLive(live);
}
const WORDS = {fit: "Refit", build: "Build", diagnose: "Diagnosis", plan: "Plan", compare: "Comparison"};
// What recordings that came in since the window was opened say by the direct method, before any fit.
function showNews() {
  const box = byId("news"), news = live.news;
  box.hidden = !news;
  box.replaceChildren(...news ? [`New recordings: ${news.lines.join("; ")}. `, news.unlisted.length
    ? element("a", "", `Add ${news.unlisted.join(", ")} to tyre.toml`, {href: "add"}) : "Refit takes them in."] : []);
}
function showStatus() {
  if (hasEnded()) dropMoves(one => !one.trial);
  showNews();
  byId("refit").disabled = hasEnded() || !!live.run;
  byId("refit").textContent = live.fits ? "Refit" : "Fit";
  byId("refit").hidden = !live.fits && !!live.run;
  byId("refit").classList.toggle("main", !live.is_fitted && !live.run);
  byId("stop").hidden = hasEnded() || !live.run;
  byId("undo").disabled = !moves.length && !hooks.canUndo();
  byId("undo").hidden = !live.fits && byId("undo").disabled;
  showLinks();
  if (hasEnded()) return say(ENDED, true);
  if (live.problem) return say(live.problem, true);
  if (live.run) return say(
    `${live.fits || live.run.kind !== "fit" ? WORDS[live.run.kind] : "First fit"}: ${live.run.sentence}`);
  if (live.fits && live.fits !== shownFit) return say("The fit has ended; its curves are being loaded.");
  if (live.last && live.last.sentence) return say(`${live.last.state}: ${live.last.sentence}`, true);
  if (live.last && live.last.state === "stopped") return say("Stopped; nothing was written.");
  say(live.is_fitted ? "The curves are those of mffit build for this tyre.toml."
    : `${live.differs.slice(0, 3).join(", ") || "tyre.toml"} differs from the fit that is shown: Refit.`);
}
function showLinks() {
  byId("add-recordings").hidden = hasEnded();
  byId("links").replaceChildren(...(hasEnded() ? [] : live.pages.filter(one => one.href || live.fits)).map(page => {
    const part = element("span");
    if (page.href) {
      const folder = page.href.replace(/[^/]*$/, "");
      part.append(element("a", "", page.old ? `${page.title} (older than tyre.toml)` : page.title,
        {href: page.href, target: "_blank"}), ...page.files.map(name =>
        element("a", "", name, {href: `${folder}${encodeURIComponent(name)}`, download: name})));
    }
    const make = key(page.href ? "again" : `Make: ${page.title.toLowerCase()}`,
      `as mffit ${page.run} on the command line, into out/`, () => post(`run/${page.run}`));
    make.disabled = !!live.run;
    if (live.fits) part.append(make);
    return part;
  }));
}

// ---- settings: every key of tyre.toml that is one value, with its default; empty fields are not written
let settingsOf = "";
async function showSettings() {
  const box = byId("settings"), home = byId("settings-keys");
  if (!box.open || settingsOf === live.digest) return;
  settingsOf = live.digest;
  const tables = await asked("settings", say);
  if (!Array.isArray(tables)) return;
  const open = new Set([...home.querySelectorAll("details[open]")].map(one => one.dataset.key)),
    at = document.activeElement.id;
  home.replaceChildren();
  for (const {title, table, file, keys} of tables) {
    const inner = details(home, title, title, open.has(title)), written = keys.filter(one => one.value).length;
    if (written) inner.querySelector("summary").append(element("span", "unit", ` ${written} written`));
    for (const one of keys) inner.append(settingRow(one, `setting ${title} ${one.key}`,
      value => ({table, key: one.key, value, ...(file ? {file} : {})})));
  }
  if (at && byId(at)) byId(at).focus();
}
function settingRow({key: name, value, default: usual, choices}, id, change) {
  const problem = element("p", "problem", "", {role: "alert"}), given = {id, onchange: () => {
    problem.textContent = "";
    edit("setting", change(field.value.trim()), found => { problem.textContent = found.sentence || found.error; });
  }};
  const options = [new Option(`(${usual || "none"})`, ""), ...choices.map(text => new Option(text, text))];
  const field = choices.length ? element("select", "", options, {...given, value})
    : element("input", "", "", {...given, value, placeholder: usual || "none"});
  return element("div", value === "" ? "setting" : "setting written",
    [element("label", "", name, {htmlFor: id}), field, problem]);
}
byId("settings").addEventListener("toggle", showSettings);

takesRecordings(say, refusals => { if (refusals.length) say(refusals.join(" "), true); else location.assign("add"); });
byId("refit").addEventListener("click", () => post("run/fit"));
byId("stop").addEventListener("click", () => post("stop"));
listen(state => state ? setLive(state) : showStatus());
showStatus();
beginProject(content.project);
