// One canvas with one picture (or two, for the wipe), drawn through the shared view.
const GRID_FROM = 12;
const NUMBERS_FROM = 64;

eq.Panel = class {
  constructor(viewer, title) {
    this.viewer = viewer;
    this.layers = [];
    this.canvas = eq.element("canvas", { role: "img", "aria-label": title });
    this.caption = eq.element("figcaption", {}, eq.element("b", {}, title));
    this.note = eq.element("span", { class: "panel-note" });
    this.caption.append(this.note);
    this.foot = eq.element("div");
    this.figure = eq.element("figure", { class: "picture" }, this.caption, this.canvas, this.foot);
    this.painted = new Map();
  }

  // layers: [{ source, look(picture) }], the second one drawn right of the wipe's edge.
  show(layers, title) {
    this.layers = layers;
    if (title) {
      this.caption.firstChild.textContent = title;
      this.canvas.setAttribute("aria-label", title);
    }
    for (const { source } of layers) this.load(source);
  }

  load(source) {
    if (source.picture || source.failure) return;
    eq.picture(source).then((picture) => { source.picture = picture; }, (error) => { source.failure = error.message; }).then(() => this.viewer.redraw());
  }

  get picture() {
    return this.layers[0]?.source.picture ?? null;
  }

  draw() {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    this.layers.forEach(({ source, look }, index) => this.drawLayer(context, source, look, index));
    const picture = this.picture;
    this.note.textContent = this.layers[0]?.source.failure ?? (picture ? this.layers[0].note ?? "" : "…");
    if (!picture) return;
    const place = this.viewer.view.place(canvas, picture);
    const classes = this.viewer.state.cls ? this.viewer.pairSource?.picture : null;
    if (classes && classes.width === picture.width && classes.height === picture.height) eq.drawClasses(context, classes, place);
    if (place.scale >= GRID_FROM) drawGrid(context, picture, place);
    if (place.scale >= NUMBERS_FROM) drawNumbers(context, picture, place, this.layers[0].prefix ?? "");
    drawBox(context, this.viewer.box, place);
    drawCursor(context, this.viewer.state, place, picture);
  }

  drawLayer(context, source, look, index) {
    const { picture } = source;
    if (!picture) return;
    const chosen = look(picture);
    const key = `${source.key} ${chosen.key}`;
    if (this.painted.get(index)?.key !== key) {
      this.painted.set(index, { key, image: eq.paint(picture, chosen) });
      if (index === 0) this.foot.replaceChildren(eq.legend(chosen.legend), oddities(picture, this.layers[0].prefix ?? ""));
    }
    const { scale, left, top } = this.viewer.view.place(this.canvas, picture);
    context.save();
    if (index === 1) {
      const edge = Math.round(this.viewer.state.wipe * this.canvas.width);
      context.fillStyle = "#fff";
      context.fillRect(edge - 1, 0, 2, this.canvas.height);
      context.beginPath();
      context.rect(edge + 1, 0, this.canvas.width, this.canvas.height);
      context.clip();
    }
    context.imageSmoothingEnabled = scale < 1;
    context.drawImage(this.painted.get(index).image, left, top, scale * picture.width, scale * picture.height);
    context.restore();
  }

  // Film pixel under a pointer event; null outside.
  pixelAt(event) {
    const { picture } = this;
    if (!picture) return null;
    const box = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / box.width;
    const { scale, left, top } = this.viewer.view.place(this.canvas, picture);
    const x = Math.floor(((event.clientX - box.left) * ratio - left) / scale);
    const y = Math.floor(((event.clientY - box.top) * ratio - top) / scale);
    return x >= 0 && y >= 0 && x < picture.width && y < picture.height ? { x, y } : null;
  }
};

const visible = (canvas, picture, { scale, left, top }) => ({
  x0: Math.max(0, Math.floor(-left / scale)), x1: Math.min(picture.width, Math.ceil((canvas.width - left) / scale)),
  y0: Math.max(0, Math.floor(-top / scale)), y1: Math.min(picture.height, Math.ceil((canvas.height - top) / scale)),
});

const drawGrid = (context, picture, place) => {
  const { x0, x1, y0, y1 } = visible(context.canvas, picture, place);
  const { scale, left, top } = place;
  context.fillStyle = "rgb(128 128 128 / 35%)";
  for (let x = x0; x <= x1; x += 1) context.fillRect(left + x * scale, top + y0 * scale, 1, (y1 - y0) * scale);
  for (let y = y0; y <= y1; y += 1) context.fillRect(left + x0 * scale, top + y * scale, (x1 - x0) * scale, 1);
};

// Zoomed in far enough, every pixel says its own values.
const drawNumbers = (context, picture, place, prefix) => {
  const { x0, x1, y0, y1 } = visible(context.canvas, picture, place);
  const { scale, left, top } = place;
  const size = Math.min(scale / 5, 14);
  context.font = `${size}px ui-monospace, "DejaVu Sans Mono", monospace`;
  context.textAlign = "center";
  context.lineJoin = "round";
  context.lineWidth = 2.5;
  context.strokeStyle = "rgb(0 0 0 / 80%)";
  for (let y = y0; y < y1; y += 1) {
    for (let x = x0; x < x1; x += 1) {
      ["R", "G", "B"].forEach((band, row) => {
        const text = eq.short(picture.planes[prefix + band][y * picture.width + x]);
        const at = [left + (x + 0.5) * scale, top + (y + 0.5) * scale + (row - 0.65) * size * 1.2];
        context.strokeText(text, ...at);
        context.fillStyle = ["#ffb3ab", "#b6f0b0", "#b5d2ff"][row];
        context.fillText(text, ...at);
      });
    }
  }
};

const drawCursor = (context, { x, y }, { scale, left, top }, picture) => {
  if (x === null || y === null || x >= picture.width || y >= picture.height) return;
  const size = Math.max(scale, 9);
  const [centreX, centreY] = [left + (x + 0.5) * scale, top + (y + 0.5) * scale];
  for (const [colour, grow, width] of [["#000", 1.5, 3], ["#fff", 1.5, 1.2]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.strokeRect(centreX - size / 2 - grow, centreY - size / 2 - grow, size + 2 * grow, size + 2 * grow);
  }
};

// The frame around the region of a cause: dashes of two kinds of light, so that it is seen on any picture.
const drawBox = (context, box, { scale, left, top }) => {
  if (!box) return;
  const margin = Math.max(2, 0.5 * scale);
  const frame = [left + box[0] * scale - margin, top + box[1] * scale - margin, (box[2] - box[0] + 1) * scale + 2 * margin, (box[3] - box[1] + 1) * scale + 2 * margin];
  for (const [colour, width, dash] of [["#000", 4, []], ["#ffd23f", 2, [7, 4]]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.strokeRect(...frame);
  }
  context.setLineDash([]);
};

// Non-finite values by kind, counted over the three bands, beside the colours that stand for them.
const oddities = (picture, prefix) => {
  const counts = { nan: 0, plusInf: 0, minusInf: 0 };
  for (const band of ["R", "G", "B"]) {
    for (const value of picture.planes[prefix + band]) if (!Number.isFinite(value)) counts[Number.isNaN(value) ? "nan" : value > 0 ? "plusInf" : "minusInf"] += 1;
  }
  const names = { nan: "NaN", plusInf: "+Inf", minusInf: "-Inf" };
  const found = Object.keys(counts).filter((kind) => counts[kind]).map((kind) => {
    const swatch = eq.element("i", { class: "swatch" });
    swatch.style.background = eq.css(eq.special[kind]);
    return eq.element("span", { "data-odd": kind }, swatch, `${counts[kind]} ${names[kind]}`);
  });
  return found.length ? eq.element("p", { class: "oddities" }, ...found) : "";
};
