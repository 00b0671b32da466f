// Numbers: what the model says of every point, and the misfit. Nothing here touches the page.
const {written, trimmed, ticks, roomy} = shared;
const byId = id => document.getElementById(id);
const content = JSON.parse(byId("data").textContent);
let project = content.project;
let rows = [];  // coefficients by index, and by name below
let coefficient = {};
let channels = [];
let columns = {};  // Float64Array by name, of every point
let own = {};  // by channel: the model at the conditions of every point
let fitOwn = {};  // the same of the fit, before any slider moved
let models, fitModels, beforeModels = null;
let misfits = {}, fitMisfits = {};  // by channel, of the present values and of the fit; see misfit
let left = new Uint8Array(0);  // 1 where a point is left out
let trial = {};  // coefficients that differ from the fit

const numbers = list => Float64Array.from(list, x => x === null ? NaN : x);
const quantity = name => project.quantities[name];
const shownIn = (name, x) => x / quantity(name).si;

function take(data) {
  project = data;
  rows = data.coefficients;
  coefficient = Object.fromEntries(rows.map(row => [row.name, row]));
  channels = data.channels.map(channel => channel.name);
  const points = data.points;
  columns = {read: {}, u: {}, used: {}};
  for (const name in data.quantities) {
    if (points[name]) columns[name] = numbers(points[name]);
    if (points.read[name]) columns.read[name] = numbers(points.read[name]);
  }
  columns.count = points.line.length;
  for (const name of channels) {
    columns.u[name] = numbers([...points.u[name], ...new Array(columns.count - points.fitted).fill(null)]);
    columns.used[name] = new Uint8Array(columns.count).fill(1);
    for (const row of points.unused[name]) columns.used[name][row] = 0;
  }
  trial = Object.fromEntries(Object.entries(trial).filter(([name]) => name in coefficient));
  fitModels = compiled(data.values);
  beforeModels = data.before ? compiled({...data.values, ...data.before.values}) : null;
  fitOwn = predicted(fitModels);
  markLeftOut(data.exclude);
  recompute();
}
function compiled(values) {
  const flipped = {...values};
  for (const name of project.conicity) flipped[name] = -values[name];
  return {"1": MODEL(values), "-1": MODEL(flipped)};
}
function predicted(by_mount) {
  const inputs = project.order.map(name => columns[name]), n = columns.count;
  const found = Object.fromEntries(channels.map(name => [name, new Float64Array(n)]));
  const [a, b, c, d, e, f, g] = inputs, mount = project.points.mount;
  for (let i = 0; i < n; i++) {
    const forces = by_mount[mount[i]](a[i], b[i], c[i], d[i], e[i], f[i], g[i]);
    for (const name of channels) found[name][i] = forces[name];
  }
  return found;
}
function recompute() {
  misfits = {};
  const changed = Object.keys(trial).length > 0;
  models = changed ? compiled({...project.values, ...trial}) : fitModels;
  own = changed ? predicted(models) : fitOwn;
}
// Points that tyre.toml leaves out: [{file, lines}], lines such as "39-44, 60".
function markLeftOut(entries) {
  const points = project.points, byFile = {};
  for (const entry of entries) {
    for (const part of entry.lines.split(",")) {
      const [first, last] = part.split("-").map(Number);
      (byFile[entry.file] ??= []).push([first, last ?? first, entry.why]);
    }
  }
  fitMisfits = {};
  version++;
  left = Uint8Array.from(points.line, (line, i) => {
    const ranges = byFile[points.files[points.file[i]]];
    return ranges && ranges.some(([first, last]) => line >= first && line <= last) ? 1 : 0;
  });
}
function whyLeftOut(i) {
  const points = project.points, file = points.files[points.file[i]];
  const inside = entry => entry.lines.split(",").some(part => {
    const [first, last] = part.split("-").map(Number);
    return points.line[i] >= first && points.line[i] <= (last ?? first);
  });
  return (project.exclude.find(entry => entry.file === file && inside(entry)) || {}).why || "";
}
// Root mean square of what the model misses, in the channel's unit and in units of the noise.
function misfit(channel, from = own) {
  const measured = columns[channel], u = columns.u[channel], used = columns.used[channel], model = from[channel];
  let sum = 0, n = 0, weighted = 0, m = 0;
  for (let i = 0; i < measured.length; i++) {
    if (left[i]) continue;
    const gap = model[i] - measured[i];
    if (!Number.isNaN(measured[i])) { sum += gap * gap; n++; }
    if (used[i] && u[i] > 0 && Number.isFinite(u[i]) && !Number.isNaN(measured[i])) { weighted += (gap / u[i]) ** 2; m++; }
  }
  return {rmse: Math.sqrt(sum / n), over_noise: Math.sqrt(weighted / m)};
}
