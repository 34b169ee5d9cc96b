// clip.js: planes of the picture's clip, and the part of a ray that stays.
import { dot, mul } from '../vectors.js';

export const mostOwnPlanes = 10;  // beside a box: kMostHtmlPlanes
const mostPlanes = mostOwnPlanes + 6;  // chord.glsl

/**
 * Planes [normal, offset], world units: what stays has normal . x >= offset.
 * clip  {box: {lower, upper} or null, planes: [{normal, offset, on}]}; null: nothing is cut
 */
export function planesOf(clip) {
  const out = [], box = clip?.box;
  for (let axis = 0; box && axis < 3; ++axis) {
    const along = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
    out.push([along, box.lower[axis]], [mul(-1, along), -box.upper[axis]]);
  }
  for (const { normal, offset, on } of clip?.planes ?? []) if (on) out.push([normal, offset]);
  return out.slice(0, mostPlanes);
}

/** Ends of the part of a ray that stays. */
export function kept({ origin, direction }, clip) {
  let [from, to] = [0, Infinity];
  for (const [normal, offset] of planesOf(clip)) {
    const slope = dot(normal, direction), gap = offset - dot(normal, origin);
    if (slope > 0) from = Math.max(from, gap / slope);
    else if (slope < 0) to = Math.min(to, gap / slope);
    else if (gap > 0) return [0, 0];
  }
  return [from, to];
}

/** Whether a ray meets a box {center, half}. */
export function meets({ center, half }, { origin, direction }) {
  let [from, to] = [0, Infinity];
  for (let axis = 0; axis < 3; ++axis) {
    const gap = center[axis] - origin[axis];
    if (direction[axis] === 0) {
      if (Math.abs(gap) > half[axis]) return false;
      continue;
    }
    const at = gap / direction[axis], reach = Math.abs(half[axis] / direction[axis]);
    [from, to] = [Math.max(from, at - reach), Math.min(to, at + reach)];
  }
  return from <= to;
}
