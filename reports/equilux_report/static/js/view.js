// One zoom and one centre for all panels. `zoom` counts device pixels per film pixel; null fits the picture into its panel.
const LEVELS = [0.125, 0.25, 0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128];

eq.View = class {
  constructor() {
    this.zoom = null;
    this.x = 0;
    this.y = 0;
  }

  // Where a picture lies on a canvas: scale and top left corner, in device pixels. Whole pixels when zoomed, so that edges are sharp.
  place(canvas, picture) {
    const scale = this.zoom ?? Math.min(canvas.width / picture.width, canvas.height / picture.height);
    if (this.zoom === null) return { scale, left: (canvas.width - scale * picture.width) / 2, top: (canvas.height - scale * picture.height) / 2 };
    return { scale, left: Math.round(canvas.width / 2 - scale * this.x), top: Math.round(canvas.height / 2 - scale * this.y) };
  }

  // Next level up or down, keeping the film position under (px, py) of the canvas where it is.
  step(direction, canvas, picture, px = canvas.width / 2, py = canvas.height / 2) {
    const { scale, left, top } = this.place(canvas, picture);
    const fit = Math.min(canvas.width / picture.width, canvas.height / picture.height);
    const next = direction > 0 ? LEVELS.find((level) => level > scale * 1.001) ?? LEVELS.at(-1) : LEVELS.findLast((level) => level < scale * 0.999) ?? null;
    if (next === null || (direction < 0 && next <= fit)) return this.fit();
    const [filmX, filmY] = [(px - left) / scale, (py - top) / scale];
    this.zoom = next;
    this.x = filmX + (canvas.width / 2 - px) / next;
    this.y = filmY + (canvas.height / 2 - py) / next;
    return this;
  }

  fit() {
    this.zoom = null;
    return this;
  }

  centre(x, y, zoom = this.zoom) {
    [this.x, this.y, this.zoom] = [x, y, zoom];
    return this;
  }

  // Move by device pixels; a fitted picture stays where it is.
  pan(dx, dy) {
    if (this.zoom === null) return;
    this.x -= dx / this.zoom;
    this.y -= dy / this.zoom;
  }
};
