// vogz.js: compact models (.vogz, docs/formats.md) whose columns browsers can unpack: table, shapes, fields. Encoder:
// src/io/vogz.
import { Bits, Bytes, Damaged, inflatedTo, takeNumbers, takeWords } from './columns.js';

const magic = [0x56, 0x4f, 0x47, 0x5a, 0x0d, 0x0a, 0x1a, 0x0a], fieldMagic = [0x56, 0x4f, 0x47, 0x46], version = 1, deflate = 1;
export const kinds = { gaussians: 0, nodes: 1, links: 2, field: 3 };
const startBytes = 48, blobBytes = 48, mostPlaceBits = 40;
const mostJson = 1 << 26, mostBlobs = 1 << 20;  // of a table that a page holds
/** Steps of a field's columns from that of its values (rounding.h). */
const changeSteps = 1.41, deviationSteps = 4, shareSteps = 32;

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
  return n;
});
/** CRC-32. */
export function checksum(bytes) {
  let crc = ~0;
  for (let n = 0; n < bytes.length; ++n) crc = (crc >>> 8) ^ crcTable[(crc ^ bytes[n]) & 255];
  return ~crc >>> 0;
}

function described(json) {
  try {
    return JSON.parse(new TextDecoder().decode(json));
  } catch {
    throw new Damaged();
  }
}

/** Beginning of a file: {json: bytes of the description, blobs: number of them, crc, end: of the header}. */
export function startOf(bytes) {
  const from = new Bytes(bytes);
  if (magic.some((byte) => byte !== from.u8())) throw new Damaged();
  const found = from.u32() & 0xffff;  // the major version
  if (found !== version) throw new Error(`a model of version ${found}, expected ${version}`);
  if (from.u32() !== deflate) throw new Error('a model packed by zstd, expected one that was written with --deflate');
  const json = from.i64(), blobs = from.i64(), packed = from.i64(), crc = from.u32();
  if (!(json >= 0 && json <= mostJson && blobs >= 0 && blobs <= mostBlobs && packed >= 0)) throw new Damaged();
  return { json, blobs, crc, end: startBytes + packed };
}

/**
 * Description of a file and the rows of its table.
 * start  of startOf
 * bytes  of the file, up to start.end at least
 * returns {file, rows: [{kind, field, depth, count, bytes, crc, box: six numbers}]}
 */
export async function headerOf({ json, blobs, crc, end }, bytes) {
  const packed = bytes.subarray(startBytes, end);
  if (packed.length !== end - startBytes || checksum(packed) !== crc) throw new Damaged();
  const body = new Bytes(await inflatedTo(packed, json + blobs * blobBytes)), file = described(body.take(json)), rows = [];
  for (let n = 0; n < blobs; ++n) {
    const [kind, field, depth, count, size, sum] = Array.from({ length: 6 }, () => body.u32());
    rows.push({ kind, field, depth, count, bytes: size, crc: sum, box: Array.from({ length: 6 }, () => body.f32()) });
  }
  return { file, rows };
}

/** Description of a file and its chunks of Gaussians: [{count, shapes, fields}], bytes of each. */
export async function opened(bytes) {
  const start = startOf(bytes), { file, rows } = await headerOf(start, bytes), from = new Bytes(bytes);
  from.take(start.end);
  file.chunks = [];
  let chunk = null;
  for (const { kind, field, count, bytes: size, crc } of rows) {
    const blob = { bytes: from.take(size), crc };
    if (kind === kinds.gaussians) file.chunks.push(chunk = { count, shapes: blob, fields: [] });
    else if (kind === kinds.nodes) chunk = null;
    else if (kind === kinds.field && chunk) chunk.fields[field] = blob;
  }
  if (!from.ended || file.chunks.reduce((sum, { count }) => sum + count, 0) !== file.gaussians) throw new Damaged();
  return file;
}

function checked({ bytes, crc }) {
  if (checksum(bytes) !== crc) throw new Damaged();
  return new Bytes(bytes);
}

// --- Shapes. ---

/** Bits 0, 3, 6, ... of 30. */
function everyThird(bits) {
  bits &= 0x09249249;
  bits = (bits | (bits >>> 2)) & 0x030c30c3;
  bits = (bits | (bits >>> 4)) & 0x0300f00f;
  bits = (bits | (bits >>> 8)) & 0x030000ff;
  return (bits | (bits >>> 16)) & 0x3ff;
}

/** Jacobi rotation in the plane of axes p and q about r: m has xx yy zz xy xz yz, quaternion is w x y z. */
function rotate(m, quaternion, p, q, r, pq, pr, qr) {
  if (m[pq] === 0) return;
  const difference = m[q] - m[p], below = Math.abs(difference) + Math.sqrt(difference * difference + 4 * m[pq] * m[pq]);
  const tangent = ((difference < 0 ? -2 : 2) * m[pq]) / below;
  const c = 1 / Math.sqrt(1 + tangent * tangent), s = tangent * c, half = Math.sqrt(0.5 * (1 + c)), turn = (-0.5 * s) / half;
  m[p] -= tangent * m[pq];
  m[q] += tangent * m[pq];
  m[pq] = 0;
  const mpr = m[pr], mqr = m[qr];
  m[pr] = c * mpr - s * mqr;
  m[qr] = s * mpr + c * mqr;
  const w = quaternion[0], x = quaternion[1 + r], y = quaternion[1 + p], z = quaternion[1 + q];
  quaternion[0] = half * w - turn * x;
  quaternion[1 + r] = half * x + turn * w;
  quaternion[1 + p] = half * y + turn * z;
  quaternion[1 + q] = half * z - turn * y;
}

/** Columns of the shapes of a chunk, read in turn, and what they say. */
async function shapeColumns(file, chunk) {
  const from = checked(chunk.shapes), { count } = chunk;
  const lattice = { cell: from.i16(), finerMean: from.u8(), finerShape: from.u8() };
  lattice.base = [from.i64(), from.i64(), from.i64()];
  lattice.massFactor = from.f64();
  const steps = await takeWords(from, count);
  const entries = [];
  for (let k = 0; k < (file.rotated ? 6 : 3); ++k) entries.push(await takeNumbers(from, count));
  const mass = await takeNumbers(from, count);
  const places = new Bits(from.take(from.u32()));
  if (!from.ended) throw new Damaged();
  return { lattice, steps, entries, mass, places, finer: 2 ** -lattice.finerShape };
}

const traceOf = ({ entries }, n) => entries[0][n] + entries[1][n] + entries[2][n];
/** Geometric mean of a Gaussian's scales. */
const spreadOf = (file, columns, n) => Math.exp((columns.finer * file.steps[0] * traceOf(columns, n)) / 3);

/** Standard deviations and rotation of each Gaussian: set(n, scales, quaternion w x y z). */
function eachShape(file, { entries, finer }, count, set) {
  const [diagonal, shear] = file.steps, m = new Float64Array(6), quaternion = new Float64Array(4);
  const scales = new Float64Array(3);
  for (let n = 0; n < count; ++n) {
    for (let k = 0; k < entries.length; ++k) m[k] = finer * (k < 3 ? diagonal : shear) * entries[k][n];
    quaternion.fill(0);
    quaternion[0] = 1;
    // Each sweep about squares the entries beside the diagonal.
    for (let sweep = 0; sweep < 5 && (m[3] || m[4] || m[5]); ++sweep) {
      rotate(m, quaternion, 0, 1, 2, 3, 4, 5);
      rotate(m, quaternion, 1, 2, 0, 5, 3, 4);
      rotate(m, quaternion, 2, 0, 1, 4, 5, 3);
    }
    if (quaternion[0] < 0) for (let k = 0; k < 4; ++k) quaternion[k] = -quaternion[k];
    for (let k = 0; k < 3; ++k) scales[k] = Math.exp(m[k]);
    set(n, scales, quaternion);
  }
}

/** Means of each Gaussian, relative to the corner of the file's lattice: set(n, axis, value). */
function eachMean(file, { lattice, steps, places, ...columns }, count, set) {
  const [atZero, perTrace] = file.exponent;
  let upper = 0, lower = 0;  // Morton code
  for (let n = 0; n < count; ++n) {
    // Half of a word, its bits inverted if the word is odd, in 64 bits.
    const invert = -(steps.lower[n] & 1), word = steps.upper[n];
    const sum = lower + ((((steps.lower[n] >>> 1) | (word << 31)) ^ invert) >>> 0);
    lower = sum >>> 0;
    upper = (upper + ((word >>> 1) ^ invert) + (sum > 0xffffffff ? 1 : 0)) >>> 0;
    const middle = (upper << 2) | (lower >>> 30), top = upper >>> 28;
    const trace = traceOf(columns, n) * columns.finer;
    const exponent = Math.max(-1000, Math.min(1000, Math.floor(atZero + perTrace * trace))) - lattice.finerMean;
    const inside = Math.max(0, Math.min(mostPlaceBits, lattice.cell - exponent));
    const edge = file.edge * 2 ** exponent;
    for (let axis = 0; axis < 3; ++axis) {
      const bit = 2 - axis;
      const cell = everyThird(lower >>> bit) + 1024 * everyThird(middle >>> bit) + 1048576 * ((top >>> bit) & 1);
      set(n, axis, edge * ((cell + lattice.base[axis]) * 2 ** inside + places.take(inside) + 0.5));
    }
  }
  if (!places.ended) throw new Damaged();
}

/**
 * Gaussians of a chunk.
 * setShape  (n, scales, quaternion, mass / (2 pi)^1.5), world units
 * setMean   (n, axis, value), relative to origin + corner
 */
export async function chunkShapes(file, chunk, setShape, setMean) {
  const columns = await shapeColumns(file, chunk), { mass, lattice } = columns;
  eachShape(file, columns, chunk.count, (n, scales, quaternion) =>
    setShape(n, scales, quaternion, lattice.massFactor * Math.exp(mass[n] * file.steps[2])));
  eachMean(file, columns, chunk.count, setMean);
}

// --- Fields. ---

/** Columns of a field of `count` Gaussians: {roots, values, changes, shares}, the last three by component. */
async function fieldColumns(from, count, vector, { scale, step }) {
  const parts = vector ? 3 : 1;
  const columns = async (number, factor) => {
    const all = [];
    for (let n = 0; n < number; ++n) all.push((await takeNumbers(from, count)).map((word) => word * factor));
    return all;
  };
  const roots = await columns(parts, step * deviationSteps);
  const values = await columns(parts, scale * step);
  const changes = await columns(3 * parts, scale * step * changeSteps);
  const shares = await columns(vector ? 3 : 1, step * shareSteps);
  return { roots, values, changes, shares };
}

/** Columns of the rotation of a quaternion w x y z. */
export function rotationAxes([w, x, y, z]) {
  return [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]];
}

/** Variance along an axis within a cutoff, for a deviation of 1 (vog/gaussians.h). */
function varianceWithin(cutoff) {
  let [mass, second] = [0, 0];
  for (let n = 0.5; n < 4096; ++n) {
    const r2 = ((n * cutoff) / 4096) ** 2, shell = r2 * Math.exp(-0.5 * r2);
    mass += shell, second += r2 * shell;
  }
  return second / (3 * mass);
}

/** Limits the plane of a scalar field to the field's range, as data/fields/field_limits.h does. */
function limit({ value, deviation, gradient, share }, scales, axes, [lower, upper], cutoff, within) {
  const [g] = gradient, room = Math.max(Math.min(upper - value[0], value[0] - lower), 0);
  const variance = axes.reduce((sum, axis, k) => sum + ((axis[0] * g[0] + axis[1] * g[1] + axis[2] * g[2]) * scales[k]) ** 2, 0);
  const extent = cutoff * Math.sqrt(variance);
  if (!(upper > lower && extent > room * (1 + 1e-5) + 1e-6 * Math.abs(value[0]))) return;
  const kept = room / extent, rest = Math.hypot(deviation[0], Math.sqrt((1 - kept * kept) * within * variance));
  for (let k = 0; k < 3; ++k) g[k] *= kept;
  share[0] *= (deviation[0] / rest) ** 3;
  deviation[0] = rest;
}

/** Field of the Gaussians of a chunk, set from `first` on; range: of a scalar field. */
async function setField(file, chunk, from, first, vector, source, range, set) {
  const { roots, values, changes, shares } = await fieldColumns(from, chunk.count, vector, source), { reference, scale, step } = source;
  const shapes = await shapeColumns(file, chunk), parts = vector ? [0, 1, 2] : [0];
  // Rounding may leave correlations that no data has; a share of the unit matrix makes up for it.
  const [most, shrink] = vector ? [1, 1 / (1 + step * shareSteps)] : [3, 1], within = varianceWithin(file.cutoff);
  const one = { value: [], deviation: [], gradient: parts.map(() => [0, 0, 0]), share: [] };
  eachShape(file, shapes, chunk.count, (n, scales, quaternion) => {
    const spread = spreadOf(file, shapes, n);
    for (const part of parts) {
      one.value[part] = values[part][n] + (vector ? 0 : reference);
      one.deviation[part] = roots[part][n] ** 2 * scale;
      for (let axis = 0; axis < 3; ++axis) one.gradient[part][axis] = changes[3 * part + axis][n] / spread;
    }
    shares.forEach((share, k) => { one.share[k] = shrink * Math.max(-most, Math.min(most, share[n])); });
    if (!vector) limit(one, scales, rotationAxes(quaternion), range, file.cutoff, within);
    set(first + n, scales, quaternion, one);
  });
}

/**
 * Field of a chunk, in the field's unit.
 * set  (n, scales, quaternion, {value, deviation, gradient [component][axis], share}): value and deviation of each component;
 *      share is the skewness, or the correlations xy xz yz
 */
export async function chunkField(file, chunk, field, set) {
  const source = file.fields[field], vector = source.kind === 'vector';
  const from = checked(chunk.fields[field]);
  await setField(file, chunk, from, 0, vector, source, [source.lower, source.upper], set);
  if (!from.ended) throw new Damaged();
}

/** The same of a whole model whose field is a file of a site's chunk (docs/streaming.md). */
export async function fileField(file, bytes, vector, range, set) {
  const from = new Bytes(bytes);
  if (fieldMagic.some((byte) => byte !== from.u8())) throw new Damaged();
  const found = from.u32();
  if (found !== version) throw new Error(`a field of version ${found}, expected ${version}`);
  const count = from.u32(), crc = from.u32();
  if (count !== file.gaussians || checksum(bytes.subarray(from.at)) !== crc) throw new Damaged();
  const source = { reference: from.f64(), scale: from.f64(), step: from.f64() };
  let first = 0;
  for (const chunk of file.chunks) {
    await setField(file, chunk, from, first, vector, source, range, set);
    first += chunk.count;
  }
  if (!from.ended) throw new Damaged();
}
