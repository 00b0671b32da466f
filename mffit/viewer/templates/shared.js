// What all pages with curves share: numbers as text, symbols, ticks of an axis.
const shared = (() => {
  const DIGITS = 4;
  function written(x, most = 6) {
    if (!Number.isFinite(x)) return "–";
    if (x === 0) return "0";
    const places = Math.max(0, DIGITS - 1 - Math.floor(Math.log10(Math.abs(x))));
    return x.toFixed(Math.min(places, most)).replace("-", "−");
  }
  const trimmed = text => text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text;
  function symbol(quantity) {
    const [letter, low] = quantity.symbol.split("_");
    const span = document.createElement("span");
    span.className = "symbol";
    span.textContent = letter;
    if (low) span.appendChild(document.createElement("sub")).textContent = low;
    return span;
  }
  function ticks(low, high, most) {
    const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 2.5, 5, 10].find(n => n * power >= raw * (1 - 1e-9));
    const found = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
    const digits = Math.max(0, Math.min(8, -Math.floor(Math.log10(step) + 1e-9) + (Math.abs(step / power - 2.5) < 1e-9 ? 1 : 0)));
    return found.map(x => ({x, text: (Math.abs(x) < step / 2 ? 0 : x).toFixed(digits).replace("-", "−")}));
  }
  function roomy([low, high]) {
    if (high - low < 1e-12) return [-1, 1];
    const room = 0.04 * (high - low);
    return [low < 0 ? low - room : low, high > 0 ? high + room : high];
  }
  // On a telephone a row is a paragraph, in which every number has the heading of its column.
  function labelled(table) {
    const headings = [...table.querySelectorAll("thead th")].map(one => one.textContent.trim());
    for (const line of table.tBodies[0].rows) headings.forEach((text, k) => { if (text && line.cells[k]) line.cells[k].dataset.label = text; });
  }
  // On paper pictures have the size, the colours and the sharpness of paper: CSS knows them by the class "paper".
  const onPaper = () => document.documentElement.classList.contains("paper");
  function whenPrinted(draw) {
    for (const event of ["beforeprint", "afterprint"]) addEventListener(event, () => {
      document.documentElement.classList.toggle("paper", event === "beforeprint");
      draw();
    });
  }
  return {written, trimmed, symbol, ticks, roomy, labelled, onPaper, whenPrinted};
})();
