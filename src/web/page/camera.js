// camera.js: a pinhole camera {eye, at, up, fov} and how a hand moves it: apps/viewer/ui/trackball.cpp
// in JavaScript. Every motion is a function of a camera. Points of the screen are [right, up] of its
// middle, in halves of its shorter side, to which the angle fov (degrees) belongs: on a wide screen
// that is the height, as everywhere in vog; on a phone held upright it is the width.
import { add, sub, mul, dot, cross, length, normalized, turned } from './vectors.js';

export function axesOf(camera) {
  const forward = normalized(sub(camera.at, camera.eye));
  const right = normalized(cross(forward, camera.up));
  return { right, up: cross(right, forward), forward };
}

export const halfTangent = (camera) => Math.tan((camera.fov * Math.PI) / 360);

/** Whether a picture can be taken: finite, looking somewhere, up not along the view. */
export function isUsable(camera) {
  const { right, up, forward } = axesOf(camera);
  return [...right, ...up, ...forward, ...camera.eye].every(Number.isFinite) &&
      camera.fov > 0 && camera.fov < 180;
}

function turnedAround(camera, axis, angle) {
  return {
    ...camera,
    eye: add(camera.at, turned(sub(camera.eye, camera.at), axis, angle)),
    up: normalized(turned(axesOf(camera).up, axis, angle)),
  };
}

/** Bell's trackball: a sphere that runs out into a hyperbola, so that no place is off the ball. */
function onBall([x, y]) {
  const radius = 0.8, r2 = x * x + y * y, inner = 0.5 * radius * radius;
  const z = r2 < inner ? Math.sqrt(radius * radius - r2) : inner / Math.sqrt(r2);
  return normalized([x, y, z]);
}

/** Turns around the centre as if a ball there were dragged. */
export function rotated(camera, from, to) {
  const a = onBall(from), b = onBall(to), across = cross(a, b), sine = length(across);
  if (sine < 1e-12) return camera;
  const { right, up, forward } = axesOf(camera);
  const axis = normalized(
    add(add(mul(across[0], right), mul(across[1], up)), mul(-across[2], forward)));
  // Twice the angle, as on a quaternion ball: half a turn from rim to rim.
  return turnedAround(camera, axis, -2 * Math.atan2(sine, dot(a, b)));
}

/** Turns around the centre, radians: rightwards about the camera's up, then upwards. */
export function orbited(camera, rightwards, upwards) {
  const aside = turnedAround(camera, axesOf(camera).up, rightwards);
  return turnedAround(aside, axesOf(aside).right, -upwards);
}

/** Turns the eye's view in place. */
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

/** Turns about the line of sight, clockwise as the picture is seen. */
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

/** Moves so that what lies at the centre's depth follows the pointer. */
export function panned(camera, from, to) {
  const scale = length(sub(camera.at, camera.eye)) * halfTangent(camera);
  return flown(camera, (from[0] - to[0]) * scale, (from[1] - to[1]) * scale, 0);
}

/** Moves towards what is under the pointer, which stays there; never stops before the volume. */
export function zoomed(camera, point, factor, leastDistance) {
  const { right, up, forward } = axesOf(camera);
  const distance = Math.max(length(sub(camera.at, camera.eye)), leastDistance);
  const slope = halfTangent(camera);
  const view = add(add(forward, mul(point[0] * slope, right)), mul(point[1] * slope, up));
  const target = add(camera.eye, mul(distance, view));
  const eye = add(target, mul(factor, sub(camera.eye, target)));
  return { ...camera, up, eye, at: add(eye, mul(Math.max(distance * factor, leastDistance), forward)) };
}

/** The same direction, from where the whole box is seen. */
export function fitted(camera, box) {
  const distance = box.radius / Math.sin(Math.atan(halfTangent(camera)));
  const { up, forward } = axesOf(camera);
  return { ...camera, up, at: box.center, eye: sub(box.center, mul(distance, forward)) };
}

/**
 * A first view, drawn nearer where a screen taller than wide would show the box small: until one of
 * its corners meets an edge.
 */
export function filling(camera, box, width, height) {
  if (width >= height) return camera;
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

/** From +x, -x, +y, ...: axis 0, 1, 2 and a sign. */
export function seenFrom(camera, box, axis, sign) {
  const eye = [0, 0, 0];
  eye[axis] = sign;
  return fitted({ ...camera, eye, at: [0, 0, 0], up: axis === 1 ? [1, 0, 0] : [0, 1, 0] }, box);
}

/** The view that has the same place in another box. */
export function carriedOver(camera, from, to) {
  const carry = (p) => add(to.center, mul(to.radius / from.radius, sub(p, from.center)));
  return { ...camera, eye: carry(camera.eye), at: carry(camera.at) };
}
