// gaussians.js: decoding of the page's models to GPU instances. Encoder: src/web/web_codec.cpp.

const chunkBytes = 20;             // corner x y z, step: float32; count: uint32
const rotationLimit = 0.383;       // kWebRotationLimit
/** Floats per instance: mean x y z, density, three scales, rotation w x y z (splat.vert). */
export const instanceFloats = 11;

export async function inflated(base64) {
  if (!('DecompressionStream' in globalThis)) throw new Error('this browser is too old to unpack it');
  const text = atob(base64.trim());
  const packed = new Uint8Array(text.length);
  for (let n = 0; n < text.length; ++n) packed[n] = text.charCodeAt(n);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Instances of one level, relative to the model's centre in its unit.
 * level   {count, rotated, chunks, rotationWords, scale: [low, step], density: [low, step]}
 * factor  of density: the extinction
 */
export async function decodeLevel(base64, level, factor) {
  const bytes = await inflated(base64);
  const { count } = level, columns = level.rotated ? 10 : 7;
  const planes = level.chunks * chunkBytes;
  if (bytes.length !== planes + 2 * columns * count) throw new Error('the page is damaged');
  const word = (column, n) => {
    const low = planes + 2 * column * count + n;
    return bytes[low] | (bytes[low + count] << 8);
  };

  const out = new Float32Array(count * instanceFloats);
  const head = new DataView(bytes.buffer, bytes.byteOffset, planes);
  let n = 0;
  for (let chunk = 0; chunk < level.chunks; ++chunk) {
    const number = (k) => head.getFloat32(chunk * chunkBytes + 4 * k, true);
    const corner = [number(0), number(1), number(2)], step = number(3);
    const end = n + head.getUint32(chunk * chunkBytes + 16, true);
    for (; n < end; ++n)
      for (let axis = 0; axis < 3; ++axis)
        out[n * instanceFloats + axis] = corner[axis] + step * word(axis, n);
  }
  if (n !== count) throw new Error('the page is damaged');

  const rotationStep = (2 * rotationLimit) / level.rotationWords;
  const logarithm = ([low, step], w) => Math.pow(2, low + step * w);
  for (n = 0; n < count; ++n) {
    const at = n * instanceFloats;
    out[at + 3] = factor * logarithm(level.density, word(columns - 1, n));
    for (let axis = 0; axis < 3; ++axis)
      out[at + 4 + axis] = logarithm(level.scale, word(3 + axis, n));
    let w2 = 1;
    for (let axis = 0; level.rotated && axis < 3; ++axis) {
      const q = word(6 + axis, n) * rotationStep - rotationLimit;
      out[at + 8 + axis] = q;
      w2 -= q * q;
    }
    out[at + 7] = Math.sqrt(Math.max(0, w2));
  }
  return out;
}
