// The numbers at one pixel: every render's radiance to the last digit, and the pair's difference, uncertainty and normalised error.
const BANDS = ["R", "G", "B"];

eq.Inspector = class {
  constructor(viewer, root) {
    this.viewer = viewer;
    this.root = root;
    this.rows = new Map();
    const body = root.querySelector("[data-inspect=radiance] tbody");
    for (const source of viewer.renders) {
      const cells = [...BANDS, "lum", "en"].map((band) => eq.element("td", { "data-value": `${source.name}.${band}` }));
      const star = source.name === viewer.config.truth ? eq.icon("truth") : "";
      body.append(eq.element("tr", {}, eq.element("th", { scope: "row" }, source.name, star), ...cells));
      this.rows.set(source.name, cells);
    }
    for (const axis of ["x", "y"]) {
      root.querySelector(`input[name=${axis}]`).addEventListener("input", () => this.typed());
    }
  }

  typed() {
    const [x, y] = ["x", "y"].map((axis) => this.root.querySelector(`input[name=${axis}]`).valueAsNumber);
    if (Number.isInteger(x) && Number.isInteger(y)) this.viewer.select(x, y);
  }

  // The hovered pixel, else the selected one.
  draw() {
    const { x, y } = this.viewer.hover ?? this.viewer.state;
    for (const [axis, value] of [["x", x], ["y", y]]) {
      const input = this.root.querySelector(`input[name=${axis}]`);
      if (document.activeElement !== input) input.value = value ?? "";
    }
    for (const source of this.viewer.renders) this.drawRender(source, x, y);
    this.drawPair(this.viewer.pairSource, x, y);
  }

  drawRender(source, x, y) {
    const cells = this.rows.get(source.name);
    const values = read(source.picture, "", x, y);
    BANDS.forEach((_, k) => write(cells[k], values ? eq.float32Text(values[k]) : "–"));
    write(cells[3], values && this.viewer.config.photometry ? eq.short(eq.luminanceOf(values), 4) : "–");
    const pair = this.viewer.pairs.find((item) => item.a === source.name && item.b === this.viewer.config.truth);
    const en = read(pair?.picture, "en.", x, y);
    const code = pair?.picture && inside(pair.picture, x, y) ? pair.picture.planes.class[y * pair.picture.width + x] : null;
    const name = eq.CLASSES[code];
    cells[4].className = name ? `class--${name}` : "";
    write(cells[4], en ? eq.short(largest(en)) : "", name);
  }

  drawPair(source, x, y) {
    const table = this.root.querySelector("[data-inspect=pair]");
    table.hidden = !source;
    if (!source) return;
    table.caption.textContent = `${source.a} − ${source.b}`;
    const rows = { difference: read(source.picture, "", x, y), en: read(source.picture, "en.", x, y) };
    // Both planes are stored to float32: so is their quotient, to about seven digits. Without a difference B cannot be told.
    rows.bound = rows.en && rows.difference.map((value, k) => (rows.en[k] !== 0 && Number.isFinite(value / rows.en[k]) ? value / rows.en[k] : null));
    for (const [name, values] of Object.entries(rows)) {
      const cells = table.querySelectorAll(`[data-row=${name}] td`);
      cells.forEach((cell, k) => write(cell, values ? (name === "bound" ? eq.short(values[k], 5) : eq.float32Text(values[k])) : "–"));
    }
    const cell = table.querySelector("[data-row=class] td");
    const code = source.picture && inside(source.picture, x, y) ? source.picture.planes.class[y * source.picture.width + x] : null;
    const name = eq.CLASSES[code];
    cell.className = name ? `class--${name}` : "";
    write(cell, name ?? "–", name);
    this.drawClasses(source);
  }

  drawClasses(source) {
    const box = this.root.querySelector(".inspector__classes");
    if (!source.picture || box.dataset.pair === source.name) return;
    box.dataset.pair = source.name;
    const counts = eq.classCounts(source.picture);
    box.replaceChildren(...eq.CLASSES.map((name) => eq.element("span", { "data-class": name }, eq.element("i", { class: `swatch swatch--${name}` }), `${name} `,
      eq.element("b", {}, eq.count(counts[name])))));
  }
};

const inside = (picture, x, y) => x !== null && y !== null && x < picture.width && y < picture.height;

const read = (picture, prefix, x, y) => {
  if (!picture || !inside(picture, x, y)) return null;
  return BANDS.map((band) => picture.planes[prefix + band][y * picture.width + x]);
};

const largest = (values) => values.find((value) => Number.isNaN(value)) ?? values.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most));

const write = (cell, text, icon = null) => {
  if (cell.dataset.text === text && cell.dataset.icon === String(icon)) return;
  cell.dataset.text = text;
  cell.dataset.icon = icon;
  cell.replaceChildren(...(icon ? [eq.icon(icon), text] : [text]));
};
