(() => {
  const {written, trimmed, ticks, roomy} = shared;
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = id => document.getElementById(id);
  const controls = Object.fromEntries(data.controls.map(control => [control.name, control]));
  const tyres = data.tyres.map((tyre, i, all) => ({
    ...tyre, shown: true, colour: `var(--c${i % 8})`,
    wide: 2 + 1.6 * (all.length - 1 - i) / Math.max(all.length - 1, 1),  // wider below, so that all remain visible
    off: MODELS.off(tyre.values), on: MODELS.on(tyre.values),
  }));
  const now = {};  // the sliders, in SI
  const bounds = {};  // of the panels; they only grow while a slider moves
  const LOADS = [0.5, 1.5];
  const SQUEEZE = 0.3;
  const STEPS = 160;
  const HEIGHT = 230, TOP = 8, BOTTOM = 24, RIGHT = 12;
  const INSIDE = 0, UNTESTED = 1, OUTSIDE = 2;
  const ZONES = ["", "untested", "outside"];
  let mode = "file", settled = true, pending = false;

  // ---- numbers

  const isOn = tyre => mode === "file" ? tyre.turn_slip : mode === "on";
  const evaluate = (tyre, condition) => (isOn(tyre) ? tyre.on : tyre.off)(...data.order.map(name => condition[name]));
  const value = (panel, found, condition) => name => name in found ? found[name] : condition[name];
  const shownIn = (name, x) => x / data.quantities[name].si;

  function zone(tyre, condition) {
    let worst = INSIDE;
    for (const name in tyre.ranges) worst = Math.max(worst, zoneOf(tyre, name, condition[name]));
    return worst;
  }
  function zoneOf(tyre, name, x) {
    const beyond = range => range !== null && (x < range[0] - slack(range) || x > range[1] + slack(range));
    const ranges = tyre.ranges[name];
    return beyond(ranges.written) ? OUTSIDE : beyond(ranges.tested) ? UNTESTED : INSIDE;
  }
  const slack = range => 1e-6 * Math.max(Math.abs(range[0]), Math.abs(range[1]));

  // A curve: its points in the units of the page, and whether each is within the tested and the written range.
  function curve(panel, tyre, fixed) {
    const swept = controls[panel.sweep || panel.x];
    const points = [];
    for (let i = 0; i <= STEPS; i++) {
      const condition = {...fixed, [swept.name]: (swept.min + (swept.max - swept.min) * i / STEPS) * swept.si};
      points.push(point(panel, tyre, condition));
    }
    return points;
  }
  function point(panel, tyre, condition) {
    const of = value(panel, evaluate(tyre, condition), condition);
    return {
      x: shownIn(panel.x, of(panel.x)), y: panel.sign * shownIn(panel.y, of(panel.y)),
      zone: zone(tyre, condition), condition,
    };
  }
  function curves(panel, tyre) {
    const found = [{points: curve(panel, tyre, now), fine: false}];
    for (const angle of panel.fan) {
      const alpha = angle * controls.alpha.si;
      if (Math.abs(alpha - now.alpha) > 1e-9) found.push({points: curve(panel, tyre, {...now, alpha}), fine: true});
    }
    if (byId("loads").checked && panel.x !== "Fz" && !panel.fan.length) {
      for (const share of LOADS) found.push({points: curve(panel, tyre, {...now, Fz: share * now.Fz}), fine: true});
    }
    return found;
  }

  // ---- text

  const symbol = name => shared.symbol(data.quantities[name]);
  const withUnit = (name, x) => `${trimmed(written(x))} ${data.quantities[name].unit}`.trim();

  // ---- pictures

  const SVG = "http://www.w3.org/2000/svg";
  function draw(parent, tag, attributes, text) {
    const node = parent.appendChild(document.createElementNS(SVG, tag));
    for (const name in attributes) node.setAttribute(name, attributes[name]);
    if (text !== undefined) node.textContent = text;
    return node;
  }
  function widened(panel, lines) {
    const all = lines.flatMap(line => line.points).filter(p => Number.isFinite(p.x) && Number.isFinite(p.y));
    const reach = axis => reached(all.filter(p => p.zone < OUTSIDE).map(p => p[axis]), all.map(p => p[axis]));
    const swept = controls[panel.x];
    let x = swept ? [swept.min, swept.max] : reach("x"), y = reach("y");
    if (!swept) x = roomy(x);
    y = roomy(y);
    const old = bounds[panel.key];
    if (old && !settled) {
      y = [Math.min(y[0], old.y[0]), Math.max(y[1], old.y[1])];
      if (!swept) x = [Math.min(x[0], old.x[0]), Math.max(x[1], old.x[1])];
    }
    return bounds[panel.key] = {x, y};
  }
  // Limits that hold zero, all points within the ranges, and points outside unless they would squeeze the others.
  function reached(inside, every) {
    const whole = [Math.min(0, ...every), Math.max(0, ...every)];
    if (!inside.length) return whole;
    const low = Math.min(0, ...inside), high = Math.max(0, ...inside), room = SQUEEZE * (high - low);
    return [Math.max(whole[0], low - room), Math.min(whole[1], high + room)];
  }

  function render(panel) {
    const figure = byId(panel.key), svg = figure.querySelector("svg");
    const shown = tyres.filter(tyre => tyre.shown);
    const lines = shown.flatMap(tyre => curves(panel, tyre).map(line => ({...line, tyre})));
    const box = widened(panel, lines), width = svg.clientWidth || 340;
    const rows = ticks(...box.y, 6);
    const left = 10 + 6.7 * Math.max(...rows.map(tick => tick.text.length));
    const X = x => left + (x - box.x[0]) / (box.x[1] - box.x[0]) * (width - left - RIGHT);
    const Y = y => HEIGHT - BOTTOM - (y - box.y[0]) / (box.y[1] - box.y[0]) * (HEIGHT - TOP - BOTTOM);
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${HEIGHT}`);
    figure.classList.toggle("flat", panel.turn_slip && !shown.some(isOn));
    for (const tick of rows) {
      draw(svg, "line", {class: "gridline", x1: left, x2: width - RIGHT, y1: Y(tick.x), y2: Y(tick.x)});
      draw(svg, "text", {x: left - 5, y: Y(tick.x) + 4, "text-anchor": "end"}, tick.text);
    }
    for (const tick of ticks(...box.x, Math.max(3, Math.min(8, (width - left) / 58)))) {
      draw(svg, "line", {class: "gridline", x1: X(tick.x), x2: X(tick.x), y1: TOP, y2: HEIGHT - BOTTOM});
      const half = 3.6 * tick.text.length;
      draw(svg, "text", {x: Math.min(X(tick.x), width - half), y: HEIGHT - 6, "text-anchor": "middle"}, tick.text);
    }
    if (box.x[0] <= 0 && box.x[1] >= 0) draw(svg, "line", {class: "axis", x1: X(0), x2: X(0), y1: TOP, y2: HEIGHT - BOTTOM});
    if (box.y[0] <= 0 && box.y[1] >= 0) draw(svg, "line", {class: "axis", x1: left, x2: width - RIGHT, y1: Y(0), y2: Y(0)});
    if (controls[panel.x]) {
      const x = X(shownIn(panel.x, now[panel.x]));
      draw(svg, "line", {class: "now", x1: x, x2: x, y1: TOP, y2: HEIGHT - BOTTOM});
    }
    draw(draw(svg, "clipPath", {id: `clip-${panel.key}`}), "rect", {
      x: left - 4, y: TOP - 4, width: width - left - RIGHT + 8, height: HEIGHT - TOP - BOTTOM + 8,
    });
    const plot = draw(svg, "g", {"clip-path": `url(#clip-${panel.key})`});
    for (const line of lines.sort((a, b) => b.fine - a.fine)) {
      for (const [kind, path] of paths(line.points, X, Y)) {
        draw(plot, "path", {class: `curve ${ZONES[kind]} ${line.fine ? "fine" : ""}`, d: path, style: `stroke:${line.tyre.colour}${line.fine ? "" : `;stroke-width:${line.tyre.wide}`}`});
      }
    }
    for (const tyre of shown) {
      const here = point(panel, tyre, now);
      if (Number.isFinite(here.y)) draw(plot, "circle", {class: "dot", cx: X(here.x), cy: Y(here.y), r: 4, style: `fill:${tyre.colour}`});
    }
    const marks = draw(svg, "g", {"clip-path": `url(#clip-${panel.key})`});
    svg.onpointermove = event => pointed(panel, figure, marks, lines, {X, Y, width}, event);
    svg.onpointerleave = () => { marks.replaceChildren(); figure.querySelector(".tip").hidden = true; };
    svg.onclick = event => {
      const nearest = nearestTo(panel, lines, {X, Y}, event, svg);
      if (nearest) set(panel.sweep || panel.x, shownIn(panel.sweep || panel.x, nearest.condition[panel.sweep || panel.x]));
    };
  }

  // Pieces of a curve by kind of range; a segment between two kinds has the one further outside.
  function* paths(points, X, Y) {
    let text = "", kind = null, last = "";
    for (const p of points) {
      if (!Number.isFinite(p.x) || !Number.isFinite(p.y)) {
        if (text.includes("L")) yield [kind, text];
        [text, kind] = ["", null];
        continue;
      }
      const place = `${X(p.x).toFixed(2)} ${Y(p.y).toFixed(2)}`;
      if (kind === null) text = `M${place}`;
      else if (p.zone <= kind) text += `L${place}`;
      if (kind !== null && p.zone !== kind) {
        if (text.includes("L")) yield [kind, text];
        text = p.zone > kind ? `M${last}L${place}` : `M${place}`;
      }
      [kind, last] = [p.zone, place];
    }
    if (text.includes("L")) yield [kind, text];
  }

  function nearestTo(panel, lines, {X, Y}, event, svg) {
    const at = svg.getBoundingClientRect(), x = event.clientX - at.left, y = event.clientY - at.top;
    const far = p => Math.abs(X(p.x) - x) + (panel.sweep ? Math.abs(Y(p.y) - y) : 0);
    const points = lines.filter(line => !line.fine).flatMap(line => line.points).filter(p => Number.isFinite(p.y));
    return points.reduce((best, p) => best === null || far(p) < far(best) ? p : best, null);
  }

  function pointed(panel, figure, marks, lines, scale, event) {
    const nearest = nearestTo(panel, lines, scale, event, figure.querySelector("svg"));
    if (!nearest) return;
    const name = panel.sweep || panel.x, x = nearest.condition[name], tip = figure.querySelector(".tip");
    marks.replaceChildren();
    if (!panel.sweep) {
      const place = scale.X(nearest.x);
      draw(marks, "line", {class: "pointer", x1: place, x2: place, y1: TOP, y2: HEIGHT - BOTTOM});
    }
    const rows = [row(symbol(name), withUnit(name, shownIn(name, x)))];
    for (const tyre of tyres.filter(one => one.shown)) {
      const p = point(panel, tyre, {...now, [name]: x});
      if (Number.isFinite(p.y)) draw(marks, "circle", {class: "dot", cx: scale.X(p.x), cy: scale.Y(p.y), r: 3.5, style: `fill:${tyre.colour}`});
      const label = document.createElement("span");
      label.textContent = tyre.name;
      label.style.color = tyre.colour;
      rows.push(row(label, (panel.sweep ? `${withUnit(panel.x, p.x)}, ` : "") + withUnit(panel.y, p.y)));
    }
    tip.replaceChildren(...rows);
    tip.hidden = false;
    const right = scale.X(nearest.x) < scale.width / 2;
    tip.style.left = right ? "auto" : "4px";
    tip.style.right = right ? "4px" : "auto";
  }
  function row(label, text) {
    const line = document.createElement("div"), cell = document.createElement("span"), number = document.createElement("b");
    cell.append(label);
    number.textContent = text;
    line.append(cell, number);
    return line;
  }

  // ---- the table of tyres

  const body = byId("legend").tBodies[0];
  const columns = ["Fx", "Fy", "Mx", "My", "Mz", "trail"];
  for (const tyre of tyres) {
    const line = body.insertRow(), first = line.insertCell();
    const label = document.createElement("label"), box = document.createElement("input");
    const swatch = document.createElement("span"), name = document.createElement("span"), about = document.createElement("span");
    box.type = "checkbox";
    box.checked = true;
    swatch.className = "swatch";
    swatch.style.background = tyre.colour;
    name.className = "name";
    name.textContent = tyre.name;
    about.className = "about";
    label.append(box, swatch, name);
    first.append(label, about);
    tyre.cells = columns.map(() => line.insertCell());
    tyre.cells.forEach(cell => cell.className = "n");
    tyre.about = about;
    box.addEventListener("change", () => {
      tyre.shown = box.checked;
      line.classList.toggle("hidden", !tyre.shown);
      update();
    });
  }
  shared.labelled(byId("legend"));
  function table() {
    for (const tyre of tyres) {
      const found = evaluate(tyre, now);
      columns.forEach((name, i) => tyre.cells[i].textContent = written(shownIn(name, found[name]), 2));
      const beyond = kind => Object.keys(tyre.ranges).filter(name => zoneOf(tyre, name, now[name]) === kind)
        .map(name => data.quantities[name].word).join(", ");
      const notes = [`turn slip ${isOn(tyre) ? "on" : "off"}`];
      if (isOn(tyre) && tyre.doubt) notes.push("its coefficients of turn slip are defaults or zero");
      if (beyond(OUTSIDE)) notes.push(`outside the file's range: ${beyond(OUTSIDE)}`);
      if (beyond(UNTESTED)) notes.push(`beyond the tested range: ${beyond(UNTESTED)}`);
      tyre.about.textContent = notes.join("; ");
      tyre.about.classList.toggle("beyond", notes.length > 1);
    }
  }

  // ---- sliders

  function set(name, shown, final = true) {
    const control = controls[name];
    if (!Number.isFinite(shown)) return;
    now[name] = shown * control.si;
    byId(name).value = shown;
    byId(`${name}-exact`).value = Number(shown.toPrecision(6));
    update(final);
  }
  function update(final = true) {
    settled = final;
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => { pending = false; all(); });
  }
  function all() {
    table();
    data.panels.forEach(render);
    byId("condition").textContent = data.controls.map(({name}) =>
      `${data.quantities[name].word} ${withUnit(name, shownIn(name, now[name]))}`).join(", ");
  }
  for (const {name} of data.controls) {
    byId(name).addEventListener("input", event => set(name, event.target.valueAsNumber, false));
    byId(name).addEventListener("change", () => update());
    byId(`${name}-exact`).addEventListener("change", event => set(name, event.target.valueAsNumber));
  }
  for (const choice of document.querySelectorAll("input[name=turn_slip]")) {
    choice.addEventListener("change", () => { mode = choice.value; update(); });
  }
  byId("loads").addEventListener("change", () => update());
  byId("reset").addEventListener("click", start);
  function start() {
    mode = "file";
    document.querySelector("input[name=turn_slip][value=file]").checked = true;
    byId("loads").checked = false;
    for (const control of data.controls) set(control.name, control.start);
  }
  byId("key-tested").hidden = !tyres.some(tyre => Object.values(tyre.ranges).some(range => range.tested));
  if (matchMedia("(max-width: 820px)").matches) byId("controls").open = false;
  addEventListener("resize", () => update());
  shared.whenPrinted(all);
  start();

  // For the console: mffit.evaluate(0, true, [Fz, alpha, gamma, kappa, phi_t, Vx, pressure]), in SI.
  window.mffit = {
    order: data.order,
    evaluate: (index, turnSlip, inputs) => (turnSlip ? tyres[index].on : tyres[index].off)(...inputs),
    curve: (key, index) => curve(data.panels.find(panel => panel.key === key), tyres[index], now),
  };
})();
