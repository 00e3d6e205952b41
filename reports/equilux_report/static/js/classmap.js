// The class of every pixel of a pair, drawn over any panel in patterns (not by colour alone) and counted.
eq.CLASSES = ["agree", "diverge", "edge", "invalid"];
const PAINT = { diverge: "#ff5a36", edge: "#38b6ff", invalid: "#ff00ff" };

// A small tile per class: strokes for diverge, dots for edge, a lattice for invalid.
const tile = (name) => {
  const canvas = eq.element("canvas");
  canvas.width = 8;
  canvas.height = 8;
  const context = canvas.getContext("2d");
  context.fillStyle = `${PAINT[name]}2b`;
  context.fillRect(0, 0, 8, 8);
  context.strokeStyle = PAINT[name];
  context.fillStyle = PAINT[name];
  context.lineWidth = 1;
  const line = (...points) => { context.beginPath(); context.moveTo(points[0], points[1]); context.lineTo(points[2], points[3]); context.stroke(); };
  if (name === "edge") { context.fillRect(1, 1, 2, 2); context.fillRect(5, 5, 2, 2); } else { line(-2, 10, 10, -2); line(-6, 6, 6, -6); line(2, 14, 14, 2); }
  if (name === "invalid") { line(-2, -2, 10, 10); line(-6, 2, 2, 10); line(6, -2, 14, 6); }
  return canvas;
};

const maskOf = (picture, number) => {
  const canvas = eq.element("canvas");
  canvas.width = picture.width;
  canvas.height = picture.height;
  const context = canvas.getContext("2d");
  const image = context.createImageData(picture.width, picture.height);
  const out = new Uint32Array(image.data.buffer);
  picture.planes.class.forEach((value, i) => { if (value === number) out[i] = 0xffffffff; });
  context.putImageData(image, 0, 0);
  return canvas;
};

const cache = new WeakMap();
const prepared = (picture) => {
  if (!cache.has(picture)) {
    const counts = eq.CLASSES.map(() => 0);
    for (const value of picture.planes.class) if (value in counts) counts[value] += 1;
    const masks = Object.keys(PAINT).filter((name) => counts[eq.CLASSES.indexOf(name)]).map((name) => [name, maskOf(picture, eq.CLASSES.indexOf(name))]);
    cache.set(picture, { counts: Object.fromEntries(eq.CLASSES.map((name, i) => [name, counts[i]])), masks });
  }
  return cache.get(picture);
};

eq.classCounts = (picture) => prepared(picture).counts;

eq.drawClasses = (context, picture, { scale, left, top }) => {
  const { width, height } = context.canvas;
  for (const [name, mask] of prepared(picture).masks) {
    const layer = new OffscreenCanvas(width, height);
    const over = layer.getContext("2d");
    over.imageSmoothingEnabled = false;
    over.drawImage(mask, left, top, scale * picture.width, scale * picture.height);
    over.globalCompositeOperation = "source-in";
    over.fillStyle = over.createPattern(tile(name), "repeat");
    over.fillRect(0, 0, width, height);
    context.drawImage(layer, 0, 0);
  }
};
