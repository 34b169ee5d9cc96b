// covered.js: the rectangle of a picture that Gaussians cover; nothing has to be finished outside of it.
import { dot, mul, sub } from '../vectors.js';
import { axesOf } from '../camera.js';
import { instanceFloats } from '../model/gaussians.js';

const padPx = 4;  // small Gaussians are drawn wider, and rays lie beside pixel centres

/** Box of the supports of instances: [lower, upper]; cutoff: deviations. */
export function boxOf(instances, cutoff) {
  const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let at = 0; at < instances.length; at += instanceFloats) {
    const reach = cutoff * Math.max(instances[at + 4], instances[at + 5], instances[at + 6]);
    for (let k = 0; k < 3; ++k) {
      box[0][k] = Math.min(box[0][k], instances[at + k] - reach);
      box[1][k] = Math.max(box[1][k], instances[at + k] + reach);
    }
  }
  return box;
}

/**
 * Pixels that parts may cover, [left, top, right, bottom]: all where some of their boxes lies beside or behind the eye.
 * perUnit  pixels a unit of slope; of parallel rays, a unit of length
 */
export function coveredBy(parts, model, camera, [width, height], perUnit) {
  const { right, up, forward } = axesOf(camera), eye = mul(1 / model.unit, sub(camera.eye, model.center)), xs = [], ys = [];
  for (const { gpu: { box } } of parts)
    for (let n = 0; n < 8; ++n) {
      const v = sub([0, 1, 2].map((k) => box[(n >> k) & 1][k]), eye), depth = camera.span ? 1 : dot(v, forward);
      if (!(depth > 0)) return [0, 0, width, height];
      xs.push(0.5 * width + (perUnit * dot(v, right)) / depth);
      ys.push(0.5 * height - (perUnit * dot(v, up)) / depth);
    }
  const low = (all, most) => Math.max(0, Math.min(most, Math.floor(Math.min(...all) - padPx)));
  const high = (all, most) => Math.max(0, Math.min(most, Math.ceil(Math.max(...all) + padPx)));
  return [low(xs, width), low(ys, height), high(xs, width), high(ys, height)];
}
