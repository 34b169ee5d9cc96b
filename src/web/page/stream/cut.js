// cut.js: cuts through the chunk tree of a model for one view: the chunks to be had, coarse ones first, and those to be drawn of what
// is there. The rule of docs/streaming.md: a chunk gives way to its parts where it is in view and its error is more than some pixels.
// What the rest of the model hides comes last.
import { dot, length, mul, sub } from '../vectors.js';
import { axesOf, halfTangent } from '../camera.js';
import { planesOf } from '../picture/clip.js';

const nearest = 1e-3;  // of an error, the least distance at which it is projected: finite numbers around the eye, in order

/** A camera for a picture in pixels: planes [normal, offset] around what is seen, normal . x >= offset; and what a length is there. */
export function viewOf(camera, width, height, clip) {
  const { right, up, forward } = axesOf(camera), { eye } = camera, parallel = camera.span > 0, side = Math.min(width, height);
  const perUnit = parallel ? side / camera.span : (0.5 * side) / halfTangent(camera);
  const planes = [[forward, dot(forward, eye)], ...planesOf(clip)];
  // Half a pixel wider, as splat.vert: sub-frames are offset.
  for (const [axis, pixels] of [[right, width], [up, height]]) {
    const reach = (0.5 * (pixels + 1)) / perUnit;
    for (const across of [axis, mul(-1, axis)]) {
      const normal = parallel ? mul(-1, across) : sub(mul(reach, forward), across);
      planes.push([normal, dot(normal, eye) - (parallel ? reach : 0)]);
    }
  }
  const corner = (0.5 * Math.hypot(width, height)) / perUnit;
  return { eye, forward, parallel, perUnit, planes, leastCosine: parallel ? 1 : 1 / Math.hypot(1, corner) };
}

/** Whether no plane of a view has all of a box behind it. */
export const isSeen = ({ center, half }, { planes }) => planes.every(([normal, offset]) =>
  dot(normal, center) + half.reduce((sum, h, k) => sum + h * Math.abs(normal[k]), 0) >= offset);

/** Error of a chunk's nodes in pixels, where its box is nearest to the eye; off the middle pixels are longer. */
export function pixelsOf({ error, box: { center, half } }, { eye, forward, parallel, perUnit, leastCosine }) {
  if (parallel) return error * perUnit;
  const to = half.map((h, k) => Math.max(center[k] - h - eye[k], 0) + Math.min(center[k] + h - eye[k], 0)), distance = length(to);
  const cosine = distance > 0 ? Math.max(dot(forward, to) / distance, leastCosine) : 1;
  return (error * perUnit) / (Math.max(distance, nearest * error) || 1) / cosine ** 2;
}

/** Heap of chunks, the one with the largest error that is seen at its top. */
class Heap {
  constructor() { this.list = []; }
  push(chunk) {
    const { list } = this;
    let at = list.push(chunk) - 1;
    for (let above; at > 0 && list[(above = (at - 1) >> 1)].shown < chunk.shown; at = above) list[at] = list[above];
    list[at] = chunk;
  }
  pop() {
    const { list } = this, top = list[0], last = list.pop();
    if (list.length === 0) return top;
    let at = 0;
    for (let below; (below = 2 * at + 1) < list.length; at = below) {
      if (below + 1 < list.length && list[below + 1].shown > list[below].shown) ++below;
      if (list[below].shown <= last.shown) break;
      list[at] = list[below];
    }
    list[at] = last;
    return top;
  }
}

/**
 * Chunks that a view wants, the largest errors that are seen divided first, until all errors are below a bound or memory is full. Sets of
 * each chunk met `pixels`, `shown`: that times how much of it is seen, and `wanted` and `divided`, the number of the turn.
 * ask      {error: pixels, room: {bytes, gaussians}, bytesOf(chunk), visible(chunk): 0 to 1, isBad(chunk): cannot be had}
 * returns  {chunks: in the order of their use, {chunk, use}; tables: [{chunk, use}] whose rows are to be had; bytes, gaussians: of
 *          all chunks; error: bound in pixels that memory leaves; shown: that of what is seen}
 */
export function wantedCut(root, view, turn, ask) {
  const out = { chunks: [], tables: [], bytes: 0, gaussians: 0, error: ask.error, shown: ask.error }, heap = new Heap();
  const take = (chunk, use, share) => {
    const pixels = pixelsOf(chunk, view);
    Object.assign(chunk, { pixels, shown: pixels * share, wanted: turn, use });
    out.chunks.push({ chunk, use });
    out.bytes += ask.bytesOf(chunk);
    out.gaussians += chunk.gaussians;
    if (chunk.nodes > 0 && pixels > ask.error) heap.push(chunk);
  };
  if (!root || !isSeen(root.box, view)) return out;
  take(root, Infinity, ask.visible(root));
  while (heap.list.length > 0) {
    const chunk = heap.pop();
    if (!chunk.parts) {
      if (!chunk.tableBad) out.tables.push({ chunk, use: chunk.shown });
      continue;
    }
    const seen = chunk.parts.filter(({ box }) => isSeen(box, view));
    if (seen.some(ask.isBad)) continue;
    const bytes = seen.reduce((sum, part) => sum + ask.bytesOf(part), 0), gaussians = seen.reduce((sum, part) => sum + part.gaussians, 0);
    if (out.bytes + bytes > ask.room.bytes || out.gaussians + gaussians > ask.room.gaussians) {
      out.error = heap.list.reduce((most, { pixels }) => Math.max(most, pixels), chunk.pixels);
      out.shown = Math.max(chunk.shown, ask.error);
      break;
    }
    chunk.divided = turn;
    // A part is worth as much as its parent's error is seen; never more than its parent, which has to be there first.
    for (const part of seen) {
      const share = ask.visible(part);
      take(part, Math.min(chunk.pixels * share, 0.999 * chunk.use), share);
    }
  }
  const most = (a, b) => b.use - a.use;
  out.chunks.sort(most);
  out.tables.sort(most);
  return out;
}

/**
 * Parts to draw of a wanted cut: nodes give way once all parts in view are there.
 * isThere  (chunk): whether it can be drawn
 * returns  {parts: [{chunk, first, count}], count: Gaussians, error: the most pixels of error of nodes that are drawn}
 */
export function drawnCut(root, turn, isThere) {
  const out = { parts: [], count: 0, error: 0 };
  const visit = (chunk) => {
    const seen = chunk.divided === turn ? chunk.parts.filter(({ wanted }) => wanted === turn) : [];
    const divided = chunk.divided === turn && seen.every(isThere), first = divided ? chunk.nodes : 0, count = chunk.gaussians - first;
    if (count > 0) out.parts.push({ chunk, first, count });
    out.count += count;
    if (divided) seen.forEach(visit);
    else if (chunk.nodes > 0) out.error = Math.max(out.error, chunk.pixels);
  };
  if (root?.wanted === turn && isThere(root)) visit(root);
  return out;
}
