// The pictures of a case: state, panels, pointer and keys. What is shown is decided here; how, in looks, panel and inspector.
const STEP = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const NUMBERS = ["x", "y", "ev", "ds", "wipe"];
const CHOICES = { mode: ["side", "flip", "wipe"], map: ["tone", "false", "log"], band: ["rgb", "lum", "R", "G", "B"] };

class Viewer extends HTMLElement {
  connectedCallback() {
    this.config = JSON.parse(this.querySelector("script[type='application/json']").textContent);
    if (!this.config.renders.length) return;
    eq.useLuminance(this.config.photometry);
    this.stop = new AbortController();
    this.renders = this.config.renders.map((item) => ({ ...item, title: item.name }));
    this.pairs = this.config.pairs.map((item) => ({ ...item }));
    this.view = new eq.View();
    this.hover = null;
    this.defaults = {
      mode: "side", map: "tone", band: "rgb", ev: this.config.stops, ds: 0, cls: false, wipe: 0.5, x: null, y: null, pair: this.config.pair ?? this.pairs[0]?.name ?? null,
      a: this.renders[0].name, b: (this.renders[1] ?? this.renders[0]).name, box: null, other: false,
    };
    this.state = { ...this.defaults };
    // A page without a wish shows its worst pixel: the numbers are there before anyone touches anything.
    const worst = this.pairSource?.worst ?? [Math.floor(this.config.width / 2), Math.floor(this.config.height / 2)];
    [this.state.x, this.state.y] = worst;
    Object.assign(this.defaults, { x: worst[0], y: worst[1] });
    this.stage = this.querySelector(".viewer__panels");
    this.adopt(eq.fragment.read());
    this.toolbar = new eq.Toolbar(this, this.querySelector("form"));
    this.inspector = new eq.Inspector(this, this.querySelector(".inspector"));
    this.listen();
    this.arrange();
  }

  disconnectedCallback() {
    this.stop?.abort();
    this.sizes?.disconnect();
  }

  listen() {
    const { signal } = this.stop;
    this.sizes = new ResizeObserver(() => this.redraw());
    this.sizes.observe(this.stage);
    window.addEventListener("hashchange", () => { this.adopt(eq.fragment.read()); this.arrange(); }, { signal });
    document.addEventListener("keydown", (event) => this.key(event), { signal });
    document.addEventListener("keyup", (event) => { if (event.key === " " && this.state.other) this.set({ other: false }); }, { signal });
    document.addEventListener("click", (event) => this.jump(event), { signal });
    this.querySelector("[data-worst]").addEventListener("click", () => this.worst(), { signal });
    this.pointer(signal);
  }

  // --- state ----------------------------------------------------------------------------------------------------------

  // Take what a fragment says; what it does not say stays as it is.
  adopt(parameters) {
    const next = { ...this.state };
    for (const name of NUMBERS) {
      const value = Number.parseFloat(parameters.get(name));
      if (Number.isFinite(value)) next[name] = value;
    }
    for (const [name, allowed] of Object.entries(CHOICES)) if (allowed.includes(parameters.get(name))) next[name] = parameters.get(name);
    for (const name of ["a", "b"]) if (this.sources().some((item) => item.name === parameters.get(name))) next[name] = parameters.get(name);
    if (this.pairs.some((pair) => pair.name === parameters.get("pair"))) next.pair = parameters.get("pair");
    if (parameters.has("box")) next.box = boxOf(parameters.get("box")) ? parameters.get("box") : null;
    if (parameters.has("cls")) next.cls = parameters.get("cls") === "1";
    const zoom = Number.parseFloat(parameters.get("z"));
    if (zoom > 0 && zoom <= 128) this.view.centre(Number.parseFloat(parameters.get("cx")) || next.x + 0.5, Number.parseFloat(parameters.get("cy")) || next.y + 0.5, zoom);
    [next.x, next.y] = this.onFilm(next.x, next.y);
    this.state = next;
    this.inspectAll();
  }

  set(changes) {
    const before = this.state;
    this.state = { ...this.state, ...changes };
    if (["mode", "a", "b", "pair", "other"].some((name) => before[name] !== this.state[name])) this.arrange();
    else this.redraw();
  }

  remember() {
    clearTimeout(this.remembering);
    this.remembering = setTimeout(() => {
      if (!this.isConnected) return;
      const { state, defaults, view } = this;
      const told = Object.fromEntries(Object.keys(defaults).filter((name) => name !== "other").map((name) => {
        const value = state[name];
        return [name, value === defaults[name] ? null : value === true ? "1" : value === false ? "0" : Number.isFinite(value) ? String(Math.round(value * 1e4) / 1e4) : value];
      }));
      if (told.x || told.y) [told.x, told.y] = [String(state.x), String(state.y)];
      const round = (value) => (view.zoom === null ? null : String(Math.round(value * 100) / 100));
      eq.fragment.write({ ...told, z: view.zoom, cx: round(view.x), cy: round(view.y) });
    }, 120);
  }

  // What the framed region spans, in film pixels: [x0, y0, x1, y1], inclusive; null where nothing is framed.
  get box() {
    return boxOf(this.state.box);
  }

  // --- what is shown --------------------------------------------------------------------------------------------------

  get pairSource() {
    return this.pairs.find((pair) => pair.name === this.state.pair) ?? null;
  }

  // Everything that a panel can show, for the flip's menus too.
  sources() {
    const maps = this.pairs.length ? [{ name: "difference", title: "difference" }, { name: "en", title: "normalised error" }] : [];
    return [...this.renders, ...maps];
  }

  layer(name) {
    const pair = this.pairSource;
    if (name === "difference") return { source: pair, look: (picture) => eq.looks.ofDifference(this.state, this.scaleOf(picture)), note: `${pair.a} − ${pair.b}` };
    if (name === "en") return { source: pair, look: () => eq.looks.ofHeat(this.state), prefix: "en.", note: `${pair.a} − ${pair.b}` };
    const source = this.renders.find((item) => item.name === name);
    return { source, look: () => eq.looks.ofRender(this.state), note: name === this.config.truth ? "truth" : source.status === "ok" ? "" : source.status };
  }

  titleOf(name) {
    return { difference: "difference a − b", en: "normalised error Eₙ" }[name] ?? name;
  }

  arrange() {
    const { mode, a, b, other } = this.state;
    const wanted = mode === "side" ? this.sources().map((item) => [item.name]) : mode === "flip" ? [[other ? b : a]] : [[a, b]];
    const shape = `${mode} ${wanted.length}`;
    if (this.shape !== shape) {
      this.shape = shape;
      this.panels = wanted.map(([name]) => new eq.Panel(this, this.titleOf(name)));
      const aspect = `${this.config.width || 4} / ${this.config.height || 3}`;
      for (const panel of this.panels) panel.canvas.style.aspectRatio = aspect;
      this.stage.dataset.mode = mode;
      this.stage.replaceChildren(...this.panels.map((panel) => panel.figure));
    }
    wanted.forEach((names, index) => this.panels[index].show(names.map((name) => this.layer(name)), names.map((name) => this.titleOf(name)).join("  |  ")));
    if (this.pairSource) this.load(this.pairSource);
    if (mode !== "side") this.renders.forEach((source) => this.load(source));
    this.redraw();
  }

  load(source) {
    if (source.picture || source.failure) return;
    eq.picture(source).then((picture) => { source.picture = picture; }, (error) => { source.failure = error.message; }).then(() => this.redraw());
  }

  // The inspector shows each render's error against the truth: those pairs are wanted as soon as it can be seen.
  inspectAll() {
    for (const pair of this.pairs) if (pair.b === this.config.truth) this.load(pair);
  }

  // Full scale of the difference: the largest one, but no less than four times the stated uncertainty, so that agreement looks calm.
  scaleOf(picture) {
    picture.scale ??= Math.max(largestOf(picture), 4 * typicalBound(picture)) || 1;
    return picture.scale * 2 ** -this.state.ds;
  }

  get scale() {
    return this.pairSource?.picture ? this.scaleOf(this.pairSource.picture) : null;
  }

  redraw() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = null;
      if (!this.isConnected) return;
      for (const panel of this.panels) panel.draw();
      this.toolbar.draw();
      this.inspector.draw();
      this.remember();
    });
  }

  // --- doing ----------------------------------------------------------------------------------------------------------

  onFilm(x, y) {
    const clamp = (value, size) => Math.min(Math.max(Math.floor(value), 0), Math.max(size - 1, 0));
    return [clamp(x, this.config.width), clamp(y, this.config.height)];
  }

  select(x, y) {
    const [onX, onY] = this.onFilm(x, y);
    this.hover = null;
    this.set({ x: onX, y: onY });
    this.follow();
  }

  // Keep the selected pixel in sight when zoomed.
  follow() {
    const panel = this.panels[0];
    if (this.view.zoom === null || !panel.picture) return;
    const { scale, left, top } = this.view.place(panel.canvas, panel.picture);
    const [px, py] = [left + (this.state.x + 0.5) * scale, top + (this.state.y + 0.5) * scale];
    if (px < scale || py < scale || px > panel.canvas.width - scale || py > panel.canvas.height - scale) this.view.centre(this.state.x + 0.5, this.state.y + 0.5);
    this.redraw();
  }

  zoom(what, panel = this.panels.find((item) => item.picture), px, py) {
    if (what === "fit") this.view.fit();
    else if (panel?.picture) {
      const chosen = px === undefined && this.view.zoom === null; // keys and buttons zoom at the selected pixel, the wheel where it is
      this.view.step(what === "in" ? 1 : -1, panel.canvas, panel.picture, px, py);
      if (chosen && this.view.zoom !== null) this.view.centre(this.state.x + 0.5, this.state.y + 0.5);
    }
    this.redraw();
  }

  worst() {
    const place = this.pairSource?.worst;
    if (!place) return;
    this.select(...place);
    this.view.centre(place[0] + 0.5, place[1] + 0.5, Math.max(this.view.zoom ?? 0, 16));
    this.redraw();
  }

  // A link to a state of this page changes what it names and nothing else.
  jump(event) {
    const link = event.target.closest?.("a[data-jump]");
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    const parameters = new URLSearchParams(link.hash.slice(1));
    this.state.box = null; // a frame belongs to what was said of one pair
    if (parameters.has("box")) this.view.fit();
    this.adopt(parameters);
    this.arrange();
    this.scrollIntoView({ block: "start" });
    this.stage.focus({ preventScroll: true });
  }

  key(event) {
    if (eq.isTyping(event)) return;
    const step = STEP[event.key];
    if (step && this.contains(document.activeElement)) {
      const by = event.shiftKey ? 10 : 1;
      const { x, y } = this.state;
      this.select(x + step[0] * by, y + step[1] * by);
      event.preventDefault();
      return;
    }
    const { state } = this;
    const actions = {
      s: () => this.set({ mode: "side" }), f: () => this.set({ mode: "flip" }), w: () => this.set({ mode: "wipe" }), c: () => this.set({ cls: !state.cls }),
      "[": () => this.set({ ev: state.ev - 0.5 }), "]": () => this.set({ ev: state.ev + 0.5 }), "{": () => this.set({ ds: state.ds - 1 }), "}": () => this.set({ ds: state.ds + 1 }),
      "+": () => this.zoom("in"), "=": () => this.zoom("in"), "-": () => this.zoom("out"), 0: () => this.zoom("fit"), g: () => this.worst(),
      Escape: () => this.set({ box: null }),
    };
    if (event.key === " " && state.mode === "flip" && !event.target.closest("button, a, summary")) {
      event.preventDefault();
      if (!event.repeat) this.set({ other: true });
    } else if (/^[1-9]$/.test(event.key) && state.mode !== "side") {
      const source = this.sources()[Number(event.key) - 1];
      if (source) this.set({ a: source.name });
    } else if (Object.hasOwn(actions, event.key)) {
      event.preventDefault();
      actions[event.key]();
    }
  }

  pointer(signal) {
    let drag = null;
    const panelOf = (event) => this.panels.find((panel) => panel.canvas === event.target);
    const ratio = () => devicePixelRatio || 1;
    const on = (name, action, options = {}) => this.stage.addEventListener(name, action, { signal, ...options });
    on("pointerdown", (event) => {
      if (event.button !== 0 || !panelOf(event)) return;
      drag = { x: event.clientX, y: event.clientY, hasMoved: false };
      event.target.setPointerCapture(event.pointerId);
    });
    on("pointermove", (event) => {
      if (drag) {
        const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
        if (!drag.hasMoved && Math.hypot(dx, dy) < 4) return;
        this.view.pan(dx * ratio(), dy * ratio());
        drag = { x: event.clientX, y: event.clientY, hasMoved: true };
      } else {
        this.hover = event.pointerType === "mouse" ? panelOf(event)?.pixelAt(event) ?? null : null;
      }
      this.redraw();
    });
    on("pointerup", (event) => {
      const at = drag && !drag.hasMoved ? panelOf(event)?.pixelAt(event) : null;
      drag = null;
      if (at) this.select(at.x, at.y);
    });
    on("pointercancel", () => { drag = null; });
    on("pointerleave", () => { this.hover = null; this.redraw(); });
    on("wheel", (event) => {
      const panel = panelOf(event);
      // Zooming out of a fitted picture is scrolling the page.
      if (!panel?.picture || (event.deltaY > 0 && this.view.zoom === null)) return;
      event.preventDefault();
      const box = panel.canvas.getBoundingClientRect();
      this.zoom(event.deltaY < 0 ? "in" : "out", panel, (event.clientX - box.left) * ratio(), (event.clientY - box.top) * ratio());
    }, { passive: false });
  }
}

const boxOf = (text) => {
  const corners = (text ?? "").split(",").map(Number);
  return corners.length === 4 && corners.every((corner) => Number.isInteger(corner) && corner >= 0) && corners[0] <= corners[2] && corners[1] <= corners[3] ? corners : null;
};

const largestOf = ({ planes }) => {
  let [counted, any] = [0, 0];
  for (const band of ["R", "G", "B"]) {
    planes[band].forEach((value, i) => {
      const size = Math.abs(value);
      if (!Number.isFinite(size)) return;
      if (size > any) any = size;
      if (size > counted && planes.class[i] < 2) counted = size;
    });
  }
  return counted || any;
};

// Median of B = (a − b) / Eₙ over a few hundred pixels.
const typicalBound = ({ planes, width, height }) => {
  const stride = Math.max(1, Math.floor((width * height) / 499));
  const bounds = [];
  for (let i = 0; i < width * height; i += stride) {
    const bound = planes.G[i] / planes["en.G"][i];
    if (Number.isFinite(bound)) bounds.push(bound);
  }
  return bounds.sort((a, b) => a - b)[bounds.length >> 1] ?? 0;
};

eq.define("eq-viewer", Viewer);

// Keys that follow links: next, previous, up.
document.addEventListener("keydown", (event) => {
  if (eq.isTyping(event)) return;
  document.querySelector(`a[data-key="${CSS.escape(event.key)}"]`)?.click();
});
