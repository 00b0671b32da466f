// The elements of a page.
export const byId = id => document.getElementById(id);
// An element with a class, what is in it (a text, or several texts and elements), and other properties.
export function element(tag, className = "", inside = "", given = {}) {
  const made = document.createElement(tag);
  made.append(...[inside].flat());
  return Object.assign(made, {className}, given);
}
export const numberField = given => element("input", "number", "", {type: "number", step: "any", ...given});
export const canvasOf = (width, height) => element("canvas", "", "", {width, height});
// A text that stays is not set again, which would lay out the page.
export function tell(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
export const key = (text, title, onclick, className = "small") =>
  element("button", className, text, {type: "button", title, onclick});
export function details(home, key, title, open) {
  const box = home.appendChild(element("details", "group", [element("summary", "", title)], {open}));
  box.dataset.key = key;
  return box;
}
// What is said of the place under the pointer, on the other side of the picture: lines of a label and a text.
export function showTip(tip, lines, isLeft) {
  tip.hidden = !lines.length;
  tip.replaceChildren(...lines.map(([label, text]) =>
    element("div", "", [element("span", "", [label]), element("b", "", text)])));
  tip.style.left = isLeft ? "auto" : "4px";
  tip.style.right = isLeft ? "4px" : "auto";
}
