// A look says how float planes become colours. Each has a key (same key: same pixels), a colour per pixel (or a loop that fills them
// all), and a legend.
const BANDS = ["R", "G", "B"];

// How the bands weigh in luminance: set by the viewer from what the results say of the case; without that Rec.709, and no cd/m².
// shares add up to what K_m multiplies, so that exposures keep their meaning when the luminance is looked at.
eq.luminance = { shares: [0.2126, 0.7152, 0.0722], kM: 1, unit: "W/(m²·sr), weighted as luminance" };
eq.useLuminance = (photometry) => {
  if (!photometry) return;
  const { weights, kM } = photometry;
  eq.luminance = { shares: weights.map((weight) => weight / kM), kM, unit: "cd/m²" };
};
eq.luminanceOf = ([r, g, b]) => eq.luminance.kM * (eq.luminance.shares[0] * r + eq.luminance.shares[1] * g + eq.luminance.shares[2] * b);

const firstOdd = (values) => values.find((value) => !Number.isFinite(value));

// One value per pixel: a band, the luminance, or (for signed quantities in RGB) the band of largest size.
const scalar = (planes, prefix, band, signed) => {
  const [r, g, b] = BANDS.map((name) => planes[prefix + name]);
  if (BANDS.includes(band)) return (i) => planes[prefix + band][i];
  const [sr, sg, sb] = eq.luminance.shares;
  if (!signed || band === "lum") return (i) => sr * r[i] + sg * g[i] + sb * b[i];
  return (i) => {
    const odd = firstOdd([r[i], g[i], b[i]]);
    if (odd !== undefined) return odd;
    const gr = Math.abs(g[i]) > Math.abs(r[i]) ? g[i] : r[i];
    return Math.abs(b[i]) > Math.abs(gr) ? b[i] : gr;
  };
};

const mapped = (value, colour) => (Number.isFinite(value) ? colour(value) : eq.odd(value));

// All three bands at once: a loop of its own, because this is what is drawn again while the exposure slider moves.
const fillTone = (gain) => (planes, out) => {
  const [r, g, b] = BANDS.map((name) => planes[name]);
  const { packed, srgbByte } = eq;
  for (let i = 0; i < out.length; i += 1) {
    const isFinite = Number.isFinite(r[i] + g[i] + b[i]);
    out[i] = isFinite ? packed(srgbByte(r[i] * gain), srgbByte(g[i] * gain), srgbByte(b[i] * gain)) : eq.odd(firstOdd([r[i], g[i], b[i]]));
  }
};

const tone = ({ ev, band }) => {
  const gain = 2 ** ev;
  const grey = (value) => mapped(value, (v) => { const level = eq.srgbByte(v * gain); return eq.packed(level, level, level); });
  return {
    key: `tone ${ev} ${band}`,
    fill: band === "rgb" ? fillTone(gain) : null,
    pixel(planes) { const value = scalar(planes, "", band, false); return (i) => grey(value(i)); },
    legend: null,
  };
};

const DECADES = 5;
const falseColour = ({ ev, band, map }) => {
  const white = 2 ** -ev;
  const isLog = map === "log";
  const isBand = BANDS.includes(band);
  const unit = isBand ? `${band}, W/(m²·sr)` : `luminance, ${eq.luminance.unit}`;
  const told = isBand ? 1 : eq.luminance.kM;
  const at = isLog ? (v) => (v > 0 ? 1 + Math.log10(v / white) / DECADES : 0) : (v) => v / white;
  const ticks = isLog ? [0, 1, 2, 3, 4, 5].map((k) => ({ at: k / DECADES, text: eq.short(told * white * 10 ** (k - DECADES), 2) }))
    : [0, 0.25, 0.5, 0.75, 1].map((t) => ({ at: t, text: eq.short(told * white * t) }));
  return {
    key: `${map} ${ev} ${band}`,
    pixel(planes) { const value = scalar(planes, "", band, false); return (i) => mapped(value(i), (v) => eq.sequentialAt(at(v))); },
    legend: { colour: eq.sequentialAt, from: 0, ticks, unit },
  };
};

const difference = ({ band }, scale) => ({
  key: `difference ${scale} ${band}`,
  pixel(planes) { const value = scalar(planes, "", band, true); return (i) => mapped(value(i), (v) => eq.divergingAt(v / scale)); },
  legend: { colour: eq.divergingAt, from: -1, ticks: [-1, -0.5, 0, 0.5, 1].map((t) => ({ at: (t + 1) / 2, text: eq.short(t * scale * (band === "lum" ? eq.luminance.kM : 1)), isMinor: Math.abs(t) === 0.5 })),
    unit: band === "lum" ? `a − b, luminance, ${eq.luminance.unit}` : `a − b, ${band === "rgb" ? "largest band" : band}, W/(m²·sr)` },
});

const HEAT_TICKS = [-1e4, -100, -1, 0, 1, 100, 1e4];
const heat = ({ band }) => ({
  key: `heat ${band}`,
  pixel(planes) {
    const value = scalar(planes, "en.", band === "lum" ? "rgb" : band, true);
    return (i) => mapped(value(i), (v) => eq.divergingAt(eq.heatPosition(v)));
  },
  legend: { colour: eq.divergingAt, from: -1, unit: `Eₙ${BANDS.includes(band) ? `, ${band}` : ", largest band"}; dim: within the uncertainty`,
    ticks: HEAT_TICKS.map((en) => ({ at: (eq.heatPosition(en) + 1) / 2, isMinor: Math.abs(en) === 100, text: Math.abs(en) === 1e4 ? `${en < 0 ? "-" : ""}10⁴` : String(en) })) },
});

eq.looks = {
  ofRender: (state) => (state.map === "tone" ? tone(state) : falseColour(state)),
  ofDifference: difference,
  ofHeat: heat,
};

// The picture in the colours of a look, at one canvas pixel per film pixel.
eq.paint = (picture, look) => {
  const canvas = eq.element("canvas");
  canvas.width = picture.width;
  canvas.height = picture.height;
  const context = canvas.getContext("2d");
  const image = context.createImageData(picture.width, picture.height);
  const out = new Uint32Array(image.data.buffer);
  if (look.fill) {
    look.fill(picture.planes, out);
  } else {
    const pixel = look.pixel(picture.planes);
    for (let i = 0; i < out.length; i += 1) out[i] = pixel(i);
  }
  context.putImageData(image, 0, 0);
  return canvas;
};
