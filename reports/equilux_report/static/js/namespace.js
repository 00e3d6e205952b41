// Custom elements are defined once the document is whole: an element may then read its own children at once.
const waiting = [];
let isReady = false;

eq.define = (name, type) => (isReady ? customElements.define(name, type) : waiting.push([name, type]));
eq.whenReady = (action) => (isReady ? action() : document.addEventListener("DOMContentLoaded", action));

document.addEventListener("DOMContentLoaded", () => {
  isReady = true;
  for (const [name, type] of waiting) customElements.define(name, type);
});

eq.element = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children);
  return element;
};

const SVG = "http://www.w3.org/2000/svg";
eq.icon = (kind) => {
  const icon = document.createElementNS(SVG, "svg");
  icon.setAttribute("class", `icon icon--${kind}`);
  icon.setAttribute("viewBox", "0 0 16 16");
  icon.setAttribute("aria-hidden", "true");
  const use = document.createElementNS(SVG, "use");
  use.setAttribute("href", `#i-${kind}`);
  icon.append(use);
  return icon;
};

eq.isTyping = (event) => event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.("input, select, textarea");
