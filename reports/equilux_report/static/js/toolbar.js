// The controls above the pictures: they write the viewer's state and show it.
eq.Toolbar = class {
  constructor(viewer, form) {
    this.viewer = viewer;
    this.form = form;
    form.addEventListener("submit", (event) => event.preventDefault());
    const fill = (name, options) => form.elements[name].replaceChildren(...options.map(([value, text]) => eq.element("option", { value }, text)));
    const pictures = viewer.sources().map((source) => [source.name, source.title]);
    fill("a", pictures);
    fill("b", pictures);
    fill("pair", viewer.pairs.map((pair) => [pair.name, `${pair.a} − ${pair.b}`]));
    if (!viewer.pairs.length) form.elements.pair.disabled = true;
    form.addEventListener("input", (event) => this.changed(event.target));
    form.querySelector("[data-auto]").addEventListener("click", () => viewer.set({ ev: viewer.config.stops }));
    for (const button of form.querySelectorAll("[data-zoom]")) button.addEventListener("click", () => viewer.zoom(button.dataset.zoom));
    form.querySelector("[data-unbox]").addEventListener("click", () => viewer.set({ box: null }));
    this.hold(form.querySelector("[data-hold]"));
  }

  changed(control) {
    const { name, type } = control;
    const value = type === "checkbox" ? control.checked : type === "range" ? control.valueAsNumber : control.value;
    this.viewer.set(name === "pair" ? { pair: value, box: null } : { [name]: value });
  }

  // The other picture shows as long as the button is held.
  hold(button) {
    const set = (isHeld) => () => this.viewer.set({ other: isHeld });
    button.addEventListener("pointerdown", set(true));
    for (const name of ["pointerup", "pointerleave", "pointercancel", "blur"]) button.addEventListener(name, set(false));
  }

  draw() {
    const { form, viewer: { state, config, view, pairs } } = this;
    for (const name of ["a", "b", "map", "band", "wipe", "mode", "ev", "ds"]) form.elements[name].value = state[name];
    if (pairs.length) form.elements.pair.value = state.pair;
    form.elements.cls.checked = state.cls;
    form.elements["ev-out"].value = `${state.ev > 0 ? "+" : ""}${Number(state.ev.toFixed(2))}, white ${eq.short(2 ** -state.ev)}`;
    form.elements["ds-out"].value = this.viewer.scale ? `± ${eq.short(this.viewer.scale)}` : "–";
    form.elements["zoom-out"].value = view.zoom === null ? "fit" : `×${view.zoom}`;
    form.dataset.mode = state.mode;
    form.querySelector("[data-unbox]").hidden = !state.box;
    form.querySelector("[data-auto]").disabled = state.ev === config.stops;
  }
};
