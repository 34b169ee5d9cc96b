// fields.js: decoding of the page's fields to GPU instances. Encoder: src/web/web_fields.cpp.
import { inflated } from './gaussians.js';

/** Floats per instance of a scalar field: value, change along each own axis, deviation, skewness. */
export const scalarFloats = 6;
/** Of a vector field: value and changes of each component, covariance xx xy xz yy yz zz, deviations. */
export const vectorFloats = 21;

/** Columns of bytes, as Columns of the encoder has them. */
class Columns {
  constructor(bytes, count, split) {
    [this.bytes, this.count, this.next, this.lows] = [bytes, count, 0, 0];
    this.low = bytes.length - count * Math.ceil(split / 4);
  }

  column() { return this.bytes.subarray(this.count * this.next, this.count * ++this.next); }

  /** Reader of numbers of 16 bits. */
  words() {
    const low = this.column(), high = this.column();
    return (n) => low[n] | (high[n] << 8);
  }

  /** Reader of numbers of 10 bits. */
  tens() {
    const high = this.column(), at = this.low + this.count * (this.lows >> 2), shift = 2 * (this.lows & 3);
    ++this.lows;
    return (n) => (high[n] << 2) | ((this.bytes[at + n] >> shift) & 3);
  }

  /** Reader of numbers from -1 to 1. */
  shares() {
    const column = this.column();
    return (n) => (column[n] - 127) / 127;
  }
}

/**
 * Instances of a field of one level, in the page's units.
 * field  {vector, levels}
 * level  {value: [[low, step], ...], change, deviation}
 */
export async function decodeField(base64, vector, level, count) {
  const parts = vector ? 3 : 1, bytes = await inflated(base64);
  if (bytes.length !== (vector ? 24 : 8) * count) throw new Error('the page is damaged');
  const columns = new Columns(bytes, count, 4 * parts), range = [...Array(parts).keys()];
  const floats = vector ? vectorFloats : scalarFloats;
  const out = new Float32Array(count * floats);
  const values = range.map(() => columns.words());
  const changes = range.map(() => [0, 1, 2].map(() => columns.tens()));
  const deviations = range.map(() => columns.tens());
  const rest = range.map(() => columns.shares());
  const square = (share) => share * Math.abs(share);
  for (let n = 0; n < count; ++n) {
    const at = n * floats;
    for (const part of range) {
      const [low, step] = level.value[part];
      out[at + 4 * part] = low + step * values[part](n);
      for (let axis = 0; axis < 3; ++axis)
        out[at + 4 * part + 1 + axis] = level.change * square((changes[part][axis](n) - 512) / 511);
    }
    const d = deviations.map((read) => level.deviation * square(read(n) / 1023));
    if (!vector) {
      out.set([d[0], 3 * rest[0](n)], at + 4);
      continue;
    }
    const [xy, xz, yz] = rest.map((read) => read(n));
    out.set([d[0] * d[0], xy * d[0] * d[1], xz * d[0] * d[2], d[1] * d[1], yz * d[1] * d[2], d[2] * d[2], ...d], at + 12);
  }
  return out;
}
