// store.js: chunks in memory, packed as they came and copied to the GPU, within bounds; the least useful go first, never one that the
// view wants.
import { instanceFloats } from '../model/gaussians.js';
import { scalarFloats, vectorFloats } from '../model/fields.js';

const floatBytes = 4;

/** What a quantity needs of each chunk: {field: its place, or null, vector}. */
export function bytesOf({ gaussians, bytes }, { field, vector }) {
  const floats = instanceFloats + (field === null ? 0 : vector ? vectorFloats : scalarFloats);
  return bytes[0] + (field === null ? 0 : bytes[1 + field]) + floatBytes * floats * gaussians;
}

/** Bytes of what is kept of a chunk. */
function keptBytes({ shapes, fields, gpu, coarse }) {
  let sum = (shapes?.length ?? 0) + (coarse?.instances.byteLength ?? 0);
  for (const data of coarse?.fields.values() ?? []) sum += data.byteLength;
  for (const packed of fields.values()) sum += packed.length;
  if (!gpu) return sum;
  let floats = instanceFloats;
  for (const { vector } of gpu.fields.values()) floats += vector ? vectorFloats : scalarFloats;
  return sum + floatBytes * floats * gpu.count;
}

export class Store {
  constructor() { this.chunks = new Set(); }

  /**
   * Memory of a chunk, made when first asked for: {shapes, fields: Map: packed, gpu: of renderer.js, busy: Set of what is being decoded,
   * coarse: of a model's root {instances, fields: Map}, for visibility.js}.
   */
  of(chunk) {
    this.chunks.add(chunk);
    return (chunk.kept ??= { shapes: null, fields: new Map(), gpu: null, busy: new Set(), coarse: null });
  }

  used() {
    const sum = { bytes: 0, gaussians: 0 };
    for (const { kept, gaussians } of this.chunks) {
      sum.bytes += keptBytes(kept);
      sum.gaussians += kept.gpu ? gaussians : 0;
    }
    return sum;
  }

  /** The GPU has lost all. */
  restart() { for (const { kept } of this.chunks) kept.gpu = null; }

  drop(chunk, renderer) {
    if (chunk.kept.gpu) renderer?.release(chunk.kept.gpu);
    chunk.kept = undefined;
    this.chunks.delete(chunk);
  }

  /** Frees a chunk's fields beside the shown one; returns the bytes. */
  dropFields({ kept }, { field }, renderer) {
    const before = keptBytes(kept);
    for (const place of [...kept.fields.keys()]) {
      if (place === field) continue;
      kept.fields.delete(place);
      kept.coarse?.fields.delete(place);
    }
    for (const place of [...(kept.gpu?.fields.keys() ?? [])])
      if (place !== field) renderer?.releaseField(kept.gpu, place);
    return before - keptBytes(kept);
  }

  /**
   * Frees memory until all is within limits, {bytes, gaussians}.
   * turn   number of the cut: what it wants stays
   * what   as of bytesOf
   */
  tidy(limits, turn, what, renderer) {
    const used = this.used(), over = () => used.bytes > limits.bytes || used.gaussians > limits.gaussians;
    if (!over()) return;
    for (const chunk of this.chunks) if (over() && chunk.kept.busy.size === 0) used.bytes -= this.dropFields(chunk, what, renderer);
    // Those below another one go before it: a chunk is drawn with all above it.
    const spare = [...this.chunks].filter(({ wanted, kept }) => wanted !== turn && kept.busy.size === 0);
    spare.sort((a, b) => a.wanted - b.wanted || b.depth - a.depth || a.use - b.use);
    for (const chunk of spare) {
      if (!over()) return;
      used.bytes -= keptBytes(chunk.kept);
      used.gaussians -= chunk.kept.gpu ? chunk.gaussians : 0;
      this.drop(chunk, renderer);
    }
  }
}
