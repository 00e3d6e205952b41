// Shortest decimal text that reads back as the same float32, bit for bit.
eq.float32Text = (value) => {
  if (Number.isNaN(value)) return "NaN";
  if (value === Infinity) return "+Inf";
  if (value === -Infinity) return "-Inf";
  if (value === 0) return Object.is(value, -0) ? "-0" : "0";
  for (let digits = 1; digits < 10; digits += 1) {
    const text = value.toPrecision(digits);
    if (Math.fround(Number(text)) === value) return Math.abs(value) < 1e-4 ? Number(text).toExponential() : String(Number(text));
  }
  return String(value);
};

// Three significant digits, as in the tables.
eq.short = (value, digits = 3) => {
  if (value === null || value === undefined) return "–";
  if (!Number.isFinite(value)) return eq.float32Text(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e6) return value.toExponential(digits - 1).replace("e+", "e");
  return size < 10 ** (digits - 1) ? value.toPrecision(digits) : String(Number(value.toPrecision(digits)));
};

eq.count = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
