// A bar of colours with ticks, below a panel.
eq.legend = (legend) => {
  if (!legend) return "";
  const stops = Array.from({ length: 65 }, (_, k) => eq.css(legend.colour(legend.from + (1 - legend.from) * (k / 64))));
  const bar = eq.element("div", { class: "legend__bar" });
  bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  const ticks = legend.ticks.map((tick) => {
    const element = eq.element("span", {}, tick.text);
    element.style.setProperty("--at", tick.at);
    if (tick.isMinor) element.className = "minor";
    return element;
  });
  return eq.element("div", { class: "legend" }, bar, eq.element("div", { class: "legend__ticks" }, ...ticks), eq.element("div", { class: "legend__unit" }, legend.unit));
};
