// What the pages of a local window share: questions to its server, and recordings that are dropped or chosen.
import {byId, element} from "./dom.js";

const PATIENCE = 3000;
export const ENDED = "The server of this window has ended. Everything that you saved is in tyre.toml; " +
  "close this page and run `mffit open` again.";
// Once the server was away, it is asked nothing more: another user of this computer may listen at its port by then.
let ended = false;
export const hasEnded = () => ended;
// What works with a server only, of the class "live", is dead at its end; so is what is made later.
export function alive(control) {
  control.classList.add("live");
  control.disabled ||= ended;
  return control;
}
function end() {
  ended = true;
  for (const control of document.querySelectorAll(".live")) control.disabled = true;
}
// The answer as an object, null without a server. A call is never given up: what it asks for may yet be done.
export async function asked(address, say, given = {}) {
  if (ended) return null;
  const late = setTimeout(() =>
    say(`No answer for ${PATIENCE / 1000} s; still waiting. Do not repeat it: it may yet be done.`, true), PATIENCE);
  try {
    const answer = await fetch(address, given);
    if (answer.status === 403) end();
    return ended ? null : await answer.json().catch(() =>
      ({error: `The server answered with status ${answer.status}; see the terminal.`}));
  } catch {
    end();
    return null;
  } finally {
    clearTimeout(late);
  }
}
export const sent = body =>
  ({method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)});
// States of the server as they come, null at its end. One page of a window listens, and tells the others.
export function listen(heard) {
  const name = `mffit ${new URL(".", location).pathname}`, pages = new BroadcastChannel(name);
  const hear = state => {
    if (state === null) end();
    heard(ended ? null : state);
  };
  const tell = state => { hear(state); pages.postMessage(state); };
  pages.onmessage = ({data}) => hear(data);
  navigator.locks.request(name, () => ended || new Promise(() => {
    const events = new EventSource("events");
    events.onmessage = message => tell(JSON.parse(message.data));
    events.onerror = () => { events.close(); tell(null); };  // or it would ask whoever is at this port next
  }));
}
async function filesOf(transfer) {
  const entries = [...transfer.items].filter(item => item.kind === "file").map(item =>
    item.webkitGetAsEntry()).filter(Boolean);
  const within = async entry => {
    if (entry.isFile) return [await new Promise((done, failed) => entry.file(done, failed))];
    const reader = entry.createReader(), found = [];
    for (let some = [null]; some.length;) {  // a reader gives a hundred at a time
      some = await new Promise((done, failed) => reader.readEntries(done, failed));
      for (const one of some) found.push(...await within(one));
    }
    return found;
  };
  return (await Promise.all(entries.map(within))).flat();
}
// Files that are dropped into the page, or chosen, are stored in the folder once the user agrees.
export function takesRecordings(say, stored) {
  const {folder, endings} = JSON.parse(byId("recordings-here").textContent);
  const isRecording = file => endings.some(ending => file.name.toLowerCase().endsWith(ending)) &&
    !file.name.startsWith(".");
  function offer(files) {
    const taken = files.filter(isRecording), dialog = byId("store"), others = files.length - taken.length;
    const these = (number, word) => number === 1 ? `this ${word}` : `these ${number} ${word}s`;
    if (!taken.length) {
      return say(`No recording among ${these(files.length, "file")}: their names end in ${endings.join(", ")}.`, true);
    }
    if (ended) return say(ENDED, true);
    const size = taken.reduce((sum, file) => sum + file.size, 0) / 1e6;
    const what = `${these(taken.length, "recording")} (${size < 0.1 ? "less than 0.1" : size.toFixed(1)} MB)`;
    const rest = others ? ` ${others} other ${others === 1 ? "file is" : "files are"} not a recording.` : "";
    byId("store-about").textContent = `Store ${what} in the folder ${folder}?${rest}`;
    byId("store-files").replaceChildren(...taken.map(file => element("li", "", file.name)));
    dialog.returnValue = "";
    dialog.onclose = () => { if (dialog.returnValue === "yes") store(taken); };
    dialog.showModal();
  }
  async function store(files) {
    const refusals = [];
    for (const [k, file] of files.entries()) {
      say(`storing ${k + 1} of ${files.length}: ${file.name}`);
      const body = await file.arrayBuffer().catch(() => null);
      const found = body ? await asked(`store/${encodeURIComponent(file.name)}`, say,
        {method: "POST", headers: {"Content-Type": "application/octet-stream"}, body})
        : {error: `${file.name} cannot be read any more; choose it again`};
      if (!found) return say(ENDED, true);
      if (found.error) refusals.push(found.error);
    }
    stored(refusals, files.length);
  }
  addEventListener("dragover", event => { event.preventDefault(); document.body.classList.add("over"); });
  addEventListener("dragleave", event => { if (!event.relatedTarget) document.body.classList.remove("over"); });
  addEventListener("drop", async event => {
    event.preventDefault();
    document.body.classList.remove("over");
    offer(await filesOf(event.dataTransfer).catch(() => []));
  });
  return offer;
}
