// The colour maps shared with the thumbnails (colour.py), as tables of packed pixels.
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

eq.packed = (r, g, b) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

const table = (text) => {
  const rgb = bytes(text);
  return Uint32Array.from({ length: rgb.length / 3 }, (_, i) => eq.packed(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]));
};

const tables = window.equiluxTables;
eq.sequential = table(tables.sequential);
eq.diverging = table(tables.diverging);
eq.special = { nan: eq.packed(...tables.nan), plusInf: eq.packed(...tables.plusInf), minusInf: eq.packed(...tables.minusInf) };

eq.css = (pixel) => `rgb(${pixel & 255} ${(pixel >> 8) & 255} ${(pixel >> 16) & 255})`;

// The colour of a non-finite value.
eq.odd = (value) => (Number.isNaN(value) ? eq.special.nan : value > 0 ? eq.special.plusInf : eq.special.minusInf);

eq.sequentialAt = (t) => eq.sequential[Math.round(255 * Math.min(1, Math.max(0, t)))];
eq.divergingAt = (t) => eq.diverging[255 + Math.round(255 * Math.min(1, Math.max(-1, t)))];

// Where a normalised error lies on the diverging map: dim within the uncertainty, a jump at 1, then logarithmic (colour.py).
eq.heatPosition = (en) => {
  const size = Math.abs(en);
  if (size <= 1) return 0.28 * en;
  return Math.sign(en) * (0.45 + 0.55 * Math.min(1, Math.log10(size) / tables.heatDecades));
};

// Linear [0, 1] to an sRGB byte, by a table fine enough to be off by less than 0.03 of a level before rounding.
const STEPS = 65536;
const encoded = Uint8Array.from({ length: STEPS + 1 }, (_, i) => {
  const linear = i / STEPS;
  return Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
});
eq.srgbByte = (linear) => encoded[linear <= 0 ? 0 : linear >= 1 ? STEPS : Math.round(linear * STEPS)];
