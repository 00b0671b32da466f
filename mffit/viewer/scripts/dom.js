// The elements of a page.
export const byId = id => document.getElementById(id);
export function element(tag, className = "", text = "", given = {}) {
  return Object.assign(document.createElement(tag), {className, textContent: text}, given);
}
// A text that stays is not set again, which would lay out the page.
export function tell(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
export function key(text, title, action) {
  const made = element("button", "small", text);
  made.type = "button";
  made.title = title;
  made.addEventListener("click", action);
  return made;
}
export function details(home, key, title, open) {
  const box = home.appendChild(element("details", "group"));
  box.dataset.key = key;
  box.open = open;
  box.append(element("summary", "", title));
  return box;
}
export function rowOf(...inside) {
  const made = document.createElement("tr");
  made.append(...inside);
  return made;
}
// What is said of the place under the pointer, on the other side of the picture: lines of a label and a text.
export function showTip(tip, lines, isLeft) {
  tip.hidden = !lines.length;
  tip.replaceChildren(...lines.map(([label, text]) => {
    const line = element("div", ""), cell = element("span", "");
    cell.append(label);
    line.append(cell, element("b", "", text));
    return line;
  }));
  tip.style.left = isLeft ? "auto" : "4px";
  tip.style.right = isLeft ? "4px" : "auto";
}
