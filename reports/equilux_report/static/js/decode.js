// From a packed payload back to Float32Array planes, bit for bit (see pack.py for the format).
const inflate = async (bytes) => {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

const fromBase64 = (text) => {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i += 1) bytes[i] = binary.charCodeAt(i);
  return bytes;
};

const unshuffle = (bytes, offset, count) => {
  const plane = new Uint8Array(4 * count);
  for (let part = 0; part < 4; part += 1) {
    for (let i = 0, from = offset + part * count; i < count; i += 1) plane[4 * i + part] = bytes[from + i];
  }
  return new Float32Array(plane.buffer);
};

eq.decode = async (header, payload) => {
  const count = header.width * header.height;
  const bytes = await inflate(fromBase64(payload));
  if (bytes.length !== 4 * count * header.stored) throw new Error(`holds ${bytes.length} bytes instead of ${4 * count * header.stored}`);
  const stored = Array.from({ length: header.stored }, (_, index) => unshuffle(bytes, 4 * count * index, count));
  const planes = Object.fromEntries(Object.entries(header.planes).map(([name, index]) => [name, stored[index]]));
  return { width: header.width, height: header.height, planes };
};
