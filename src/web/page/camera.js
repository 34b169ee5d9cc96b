// camera.js: camera {eye, at, up, fov, span} and its motions by pointer and keys, as in
// apps/viewer/ui/trackball.cpp. A span above 0 is an orthographic camera's: world units across the
// shorter side of the screen, in place of fov. Every motion returns a new camera. Screen points are [right, up] from
// the centre in units of half the shorter side, which also spans the angle fov (degrees): the height
// of a wide screen, as everywhere in vog, but the width of a tall one.
import { add, sub, mul, dot, cross, length, normalized, turned } from './vectors.js';

export function axesOf(camera) {
  const forward = normalized(sub(camera.at, camera.eye));
  const right = normalized(cross(forward, camera.up));
  return { right, up: cross(right, forward), forward };
}

export const halfTangent = (camera) => Math.tan((camera.fov * Math.PI) / 360);

/** Whether the camera is valid: finite, eye and centre distinct, up not parallel to the view. */
export function isUsable(camera) {
  const { right, up, forward } = axesOf(camera);
  return [...right, ...up, ...forward, ...camera.eye].every(Number.isFinite) &&
      camera.fov > 0 && camera.fov < 180 && !(camera.span < 0) && camera.span !== Infinity;
}

/** Half of the shorter side of the screen at the centre's depth, world units. */
const halfSide = (camera) =>
  (camera.span ? 0.5 * camera.span : length(sub(camera.at, camera.eye)) * halfTangent(camera));

/** Parallel rays in place of a pinhole, or back; what lies at the centre keeps its size. */
export function withOtherProjection(camera) {
  if (!camera.span) return { ...camera, span: 2 * halfSide(camera) };
  const distance = halfSide(camera) / halfTangent(camera);
  return { ...camera, span: 0, eye: sub(camera.at, mul(distance, axesOf(camera).forward)) };
}

function turnedAround(camera, axis, angle) {
  return {
    ...camera,
    eye: add(camera.at, turned(sub(camera.eye, camera.at), axis, angle)),
    up: normalized(turned(axesOf(camera).up, axis, angle)),
  };
}

/** Point on Bell's trackball: a sphere that continues as a hyperbola, defined on the whole plane. */
function onBall([x, y]) {
  const radius = 0.8, r2 = x * x + y * y, inner = 0.5 * radius * radius;
  const z = r2 < inner ? Math.sqrt(radius * radius - r2) : inner / Math.sqrt(r2);
  return normalized([x, y, z]);
}

/** Rotates around the centre like a dragged ball. */
export function rotated(camera, from, to) {
  const a = onBall(from), b = onBall(to), across = cross(a, b), sine = length(across);
  if (sine < 1e-12) return camera;
  const { right, up, forward } = axesOf(camera);
  const axis = normalized(
    add(add(mul(across[0], right), mul(across[1], up)), mul(-across[2], forward)));
  // Twice the angle, as for quaternion balls: half a turn from rim to rim.
  return turnedAround(camera, axis, -2 * Math.atan2(sine, dot(a, b)));
}

/** Rotates around the centre, radians: about the camera's up, then about its right axis. */
export function orbited(camera, rightwards, upwards) {
  const aside = turnedAround(camera, axesOf(camera).up, rightwards);
  return turnedAround(aside, axesOf(aside).right, -upwards);
}

/** Rotates the view about the eye, radians. */
export function lookedAround(camera, rightwards, upwards) {
  const { right, up } = axesOf(camera);
  const aside = turned(right, up, -rightwards);
  const view = turned(sub(camera.at, camera.eye), up, -rightwards);
  return {
    ...camera,
    at: add(camera.eye, turned(view, aside, upwards)),
    up: normalized(turned(up, aside, upwards)),
  };
}

/** Rotates about the line of sight, radians clockwise on the screen. */
export function rolled(camera, angle) {
  const { up, forward } = axesOf(camera);
  return { ...camera, up: normalized(turned(up, forward, -angle)) };
}

/** Moves eye and centre along the camera's axes, world units. */
export function flown(camera, rightwards, upwards, ahead) {
  const { right, up, forward } = axesOf(camera);
  const step = add(add(mul(rightwards, right), mul(upwards, up)), mul(ahead, forward));
  return { ...camera, eye: add(camera.eye, step), at: add(camera.at, step) };
}

/** Translates so that points at the centre's depth follow the pointer. */
export function panned(camera, from, to) {
  const scale = halfSide(camera);
  return flown(camera, (from[0] - to[0]) * scale, (from[1] - to[1]) * scale, 0);
}

/** Moves towards the point below the pointer, which stays there; may pass through the volume. */
export function zoomed(camera, point, factor, leastDistance) {
  const { right, up, forward } = axesOf(camera);
  if (camera.span) {
    const shift = (1 - factor) * halfSide(camera);
    return { ...flown(camera, point[0] * shift, point[1] * shift, 0), span: camera.span * factor };
  }
  const distance = Math.max(length(sub(camera.at, camera.eye)), leastDistance);
  const slope = halfTangent(camera);
  const view = add(add(forward, mul(point[0] * slope, right)), mul(point[1] * slope, up));
  const target = add(camera.eye, mul(distance, view));
  const eye = add(target, mul(factor, sub(camera.eye, target)));
  return { ...camera, up, eye, at: add(eye, mul(Math.max(distance * factor, leastDistance), forward)) };
}

/** Same direction, at the distance where the whole box is visible. */
export function fitted(camera, box) {
  const distance = box.radius / Math.sin(Math.atan(halfTangent(camera)));
  const { up, forward } = axesOf(camera);
  const span = camera.span ? 2 * box.radius : 0;
  return { ...camera, span, up, at: box.center, eye: sub(box.center, mul(distance, forward)) };
}

/**
 * Initial view for a screen taller than wide: moved nearer until a corner of the box meets an edge.
 */
export function filling(camera, box, width, height) {
  if (width >= height || camera.span) return camera;
  const { right, up, forward } = axesOf(camera), slope = halfTangent(camera);
  const margin = 1.03;
  let least = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const sign = (bit) => (corner & bit ? 1 : -1);
    const p = [0, 1, 2].map((axis) => box.center[axis] + sign(1 << axis) * box.half[axis]);
    const from = sub(p, camera.at), depth = dot(from, forward);
    const across = Math.max(Math.abs(dot(from, right)), (Math.abs(dot(from, up)) * width) / height);
    least = Math.max(least, (margin * across) / slope - depth);
  }
  const distance = length(sub(camera.at, camera.eye));
  if (least <= 0 || least >= distance) return camera;
  return { ...camera, eye: sub(camera.at, mul(least, forward)) };
}

/**
 * View from an axis, 0 to 2, and a sign: +x, -x, +y, ...
 * upright  vertical direction of the data; a view along it is one from above or below
 */
export function seenFrom(camera, box, axis, sign, upright) {
  const eye = [0, 0, 0];
  eye[axis] = sign;
  // As `vog render --view`: the limit of views from B of vog/camera.h, z for y up and -y for z up.
  const b = turnedUpright([0, 0, 1], upright);
  const along = dot(eye, upright);
  const up = Math.abs(along) > 1 - 1e-9 ? mul(-Math.sign(along), b) : upright;
  return fitted({ ...camera, eye, at: [0, 0, 0], up }, box);
}

/** A vector turned by the shortest rotation from y to a unit vector. */
function turnedUpright(v, upright) {
  const cosine = upright[1];
  if (1 + cosine < 1e-9) return [v[0], -v[1], -v[2]];
  const k = cross([0, 1, 0], upright), once = cross(k, v);
  return add(add(v, once), mul(1 / (1 + cosine), cross(k, once)));
}

/** Camera at the same place relative to another box. */
export function carriedOver(camera, from, to) {
  const carry = (p) => add(to.center, mul(to.radius / from.radius, sub(p, from.center)));
  const span = (camera.span ?? 0) * (to.radius / from.radius);
  return { ...camera, span, eye: carry(camera.eye), at: carry(camera.at) };
}
