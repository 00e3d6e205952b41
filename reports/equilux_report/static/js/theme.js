// Light, dark, or as the system says. Storage may be forbidden for pages from file://: then the choice lasts for the page.
const KEY = "equilux-theme";
const ORDER = ["auto", "light", "dark"];

const stored = () => {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
};

const apply = (theme) => {
  document.documentElement.dataset.theme = ORDER.includes(theme) ? theme : "auto";
  document.dispatchEvent(new CustomEvent("equilux-theme"));
};

apply(stored());

eq.define("eq-theme", class extends HTMLElement {
  connectedCallback() {
    const button = eq.element("button", { type: "button", class: "button theme", title: "Light, dark, or as the system says" });
    const show = () => { button.textContent = `theme: ${document.documentElement.dataset.theme}`; };
    button.addEventListener("click", () => {
      const theme = ORDER[(ORDER.indexOf(document.documentElement.dataset.theme) + 1) % ORDER.length];
      try {
        localStorage.setItem(KEY, theme);
      } catch {
        // not remembered, but applied
      }
      apply(theme);
      show();
    });
    show();
    this.replaceChildren(button);
  }
});
