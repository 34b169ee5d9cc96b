// columns.js: columns of whole numbers of compact models. Encoder: src/io/vogz/columns.cpp.

const direct = 192, leastWidth = 8;           // symbols below are upper parts themselves, others widths
const mostLowBits = 48, mostExtraBits = 57;
const forms = { constant: 0, plain: 1, compressed: 2 };
const predictions = { fixed: 0, previous: 1, meanOfFour: 2 };
const half = 2 ** 32;

export class Damaged extends Error {
  constructor() { super('the page is damaged'); }
}

/** Bytes of a zlib stream. */
export async function inflated(packed) {
  try {
    return new Uint8Array(await new Response(inflating(packed)).arrayBuffer());
  } catch {
    throw new Damaged();
  }
}

/** Likewise, of exactly `count` bytes: a stream of a hostile file ends there. */
export async function inflatedTo(packed, count) {
  const out = new Uint8Array(count), reader = inflating(packed).getReader();
  let at = 0;
  try {
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      out.set(part.value, at);  // throws beyond the end
      at += part.value.length;
    }
  } catch {
    reader.cancel().catch(() => {});
    throw new Damaged();
  }
  if (at !== count) throw new Damaged();
  return out;
}

function inflating(packed) {
  if (!('DecompressionStream' in globalThis)) throw new Error('this browser is too old to unpack it');
  return new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
}

/** Numbers and runs of bytes, little-endian, in turn. */
export class Bytes {
  constructor(bytes) {
    [this.bytes, this.at] = [bytes, 0];
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  }
  take(count) {
    if (!(count >= 0 && this.at + count <= this.bytes.length)) throw new Damaged();
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }
  number(type, size) {
    this.take(size);
    return this.view[`get${type}`](this.at - size, true);
  }
  u8() { return this.number('Uint8', 1); }
  i16() { return this.number('Int16', 2); }
  u32() { return this.number('Uint32', 4); }
  f32() { return this.number('Float32', 4); }
  i64() { return Number(this.number('BigInt64', 8)); }
  f64() { return this.number('Float64', 8); }
  get ended() { return this.at === this.bytes.length; }
}

/** Numbers of any number of bits, least significant first. */
export class Bits {
  constructor(bytes) { [this.bytes, this.bit] = [bytes, 0]; }
  /** Next number, exact below 2^53; zeros behind the end. count: up to 57 */
  take(count) {
    if (count > 24) return this.take(24) + this.take(count - 24) * 2 ** 24;
    const { bytes, bit } = this, at = bit >>> 3;
    this.bit = bit + count;
    const load = bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (bytes[at + 3] << 24);
    return (load >>> (bit & 7)) & ((1 << count) - 1);
  }
  /** Likewise, exact. */
  big(count) {
    let number = 0n;
    for (let got = 0; got < count; got += 24)
      number |= BigInt(this.take(Math.min(24, count - got))) << BigInt(got);
    return number;
  }
  get ended() { return (this.bit + 7) >>> 3 === this.bytes.length; }
}

/** Words of 64 bits as their upper and lower halves. */
export async function takeWords(from, count) {
  const form = from.u8(), lowBits = from.u8(), size = from.u32(), packed = from.u32();
  if (form > forms.compressed || lowBits > mostLowBits) throw new Damaged();
  const stored = from.take(size), bits = new Bits(from.take(packed));
  const symbols = form === forms.compressed ? await inflated(stored) :
    form === forms.plain ? stored : new Uint8Array(count).fill(stored[0]);
  if (symbols.length !== count || (form === forms.constant && size !== Math.min(count, 1))) throw new Damaged();
  const words = { upper: new Uint32Array(count), lower: new Uint32Array(count) };
  const factor = 2 ** lowBits;
  for (let n = 0; n < count; ++n) {
    const symbol = symbols[n], extra = symbol < direct ? 0 : symbol - direct + leastWidth - 1;
    if (extra > mostExtraBits) throw new Damaged();
    if (extra + lowBits < 52) {
      const word = (symbol < direct ? symbol : 2 ** extra + bits.take(extra)) * factor + bits.take(lowBits);
      words.lower[n] = word >>> 0;
      words.upper[n] = word / half;
    } else {
      const top = symbol < direct ? BigInt(symbol) : (1n << BigInt(extra)) | bits.big(extra);
      const word = (top << BigInt(lowBits)) | bits.big(lowBits);
      words.lower[n] = Number(word & 0xffffffffn);
      words.upper[n] = Number((word >> 32n) & 0xffffffffn);
    }
  }
  if (!bits.ended) throw new Damaged();
  return words;
}

/** Numbers, each coded as its difference from a prediction by those before it. */
export async function takeNumbers(from, count) {
  const prediction = from.u8(), base = from.i64();
  if (prediction > predictions.meanOfFour) throw new Damaged();
  const { upper, lower } = await takeWords(from, count);
  const numbers = new Float64Array(count);
  let a = base, b = base, c = base, d = base;  // the last four
  for (let n = 0; n < count; ++n) {
    const word = upper[n] * half + lower[n], difference = lower[n] & 1 ? -(word + 1) / 2 : word / 2;
    const predicted = prediction === predictions.fixed ? base :
      prediction === predictions.previous ? a : Math.floor((a + b + c + d + 2) / 4);
    numbers[n] = predicted + difference;
    d = c, c = b, b = a, a = numbers[n];
  }
  return numbers;
}
