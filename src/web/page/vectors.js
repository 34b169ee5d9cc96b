// vectors.js: arithmetic of vectors [x, y, z].
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const mul = (s, a) => [s * a[0], s * a[1], s * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(...a);
export const normalized = (a) => mul(1 / length(a), a);

/** Rotation about an axis of unit length by Rodrigues' formula; radians. */
export function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return add(add(mul(c, v), mul(s, cross(axis, v))), mul((1 - c) * dot(axis, v), axis));
}

/** Whether two lists have the same members. */
export const isSame = (a, b) => a.length === b.length && a.every((one, n) => one === b[n]);
