// probe.js: what one ray meets in a volume picture: its opacity, and the field's value at the first opaque depth, where
// the opacity of what lies in front passes one half. From the decoded Gaussians, exactly along the ray.
import { add, dot, length, mul, sub } from '../vectors.js';
import { axesOf, halfTangent } from '../camera.js';
import { instanceFloats } from '../model/gaussians.js';
import { scalarFloats } from '../model/fields.js';
import { below, extinctionIn, lightOf, steepOf } from './transfer.js';
import { kept } from './clip.js';

const opaque = 0.5, coarse = 512, fine = 64;  // steps along the ray, then in the one that passes

/** Ray through a pixel [column, row] of a picture, world units. */
export function rayOf(camera, [column, row], width, height) {
  const { right, up, forward } = axesOf(camera), side = Math.min(width, height);
  const perUnit = camera.span ? side / camera.span : (0.5 * side) / halfTangent(camera);
  const aside = add(mul((column + 0.5 - 0.5 * width) / perUnit, right), mul((0.5 * height - row - 0.5) / perUnit, up));
  if (camera.span) return { origin: add(camera.eye, aside), direction: forward };
  const along = add(forward, aside);
  return { origin: camera.eye, direction: mul(1 / length(along), along) };
}

/**
 * Adds Gaussians on a ray, by their normal distributions along it: {at, deviation, start, end, mass, value, rate, rest},
 * depths in the page's units, value at depth 0 and its change a depth, rest: deviation of the residual, gradient: a unit of the model.
 */
function addHits(hits, model, { instances, data, first, count }, ray, [near, far]) {
  const origin = mul(1 / model.unit, sub(ray.origin, model.center)), d = ray.direction, k2 = model.cutoff ** 2;
  for (let n = first, i = n * instanceFloats, f = n * scalarFloats; n < first + count; ++n, i += instanceFloats, f += scalarFloats) {
    const ex = origin[0] - instances[i], ey = origin[1] - instances[i + 1], ez = origin[2] - instances[i + 2];
    const sx = instances[i + 4], sy = instances[i + 5], sz = instances[i + 6];
    const along = ex * d[0] + ey * d[1] + ez * d[2], widest = Math.max(sx, sy, sz);
    if (ex * ex + ey * ey + ez * ez - along * along > k2 * widest * widest) continue;
    const w = instances[i + 7], x = instances[i + 8], y = instances[i + 9], z = instances[i + 10];
    // Columns of the rotation: own axes in the world.
    const axes = [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
    const scale = [sx, sy, sz];
    const a = axes.map((axis, n) => (axis[0] * ex + axis[1] * ey + axis[2] * ez) / scale[n]);
    const b = axes.map((axis, n) => dot(axis, d) / scale[n]);
    const bb = dot(b, b), at = -dot(a, b) / bb, m2 = dot(a, a) - bb * at * at;
    if (!(m2 < k2)) continue;
    const deviation = 1 / Math.sqrt(bb), reach = Math.sqrt(k2 - m2) * deviation;
    const start = Math.max(at - reach, near / model.unit), end = Math.min(at + reach, far / model.unit);
    if (!(start < end)) continue;
    const change = [data[f + 1], data[f + 2], data[f + 3]];
    const gradient = axes.reduce((sum, axis, k) => add(sum, mul(change[k] / scale[k], axis)), [0, 0, 0]);
    hits.push({
      gradient, at, deviation, start, end, rest: data[f + 4], value: data[f] + dot(change, a), rate: dot(change, b),
      mass: instances[i + 3] * Math.exp(-0.5 * m2) * Math.sqrt(2 * Math.PI) * deviation,
    });
  }
}

/** Optical depths of equal steps between two depths: moments of each step, then the extinction of these and of their mean gradient. */
function depthsOf(hits, { extinction, steep }, from, to, steps) {
  const sums = Array.from({ length: steps }, () => [0, 0, 0, 0, 0, 0]), step = (to - from) / steps;
  for (const hit of hits) {
    const [start, end] = [Math.max(hit.start, from), Math.min(hit.end, to)];
    if (!(start < end)) continue;
    let before = below((start - hit.at) / hit.deviation), left = start;
    for (let n = Math.floor((start - from) / step); n < steps && left < end; ++n) {
      const right = Math.min(from + (n + 1) * step, end), after = below((right - hit.at) / hit.deviation);
      const part = hit.mass * (after - before), value = hit.value + 0.5 * (left + right) * hit.rate;
      [part, part * value, part * (value ** 2 + hit.rest ** 2), ...mul(part, hit.gradient)].forEach((v, k) => { sums[n][k] += v; });
      [before, left] = [after, right];
    }
  }
  return sums.map(([part, first, second, ...gradient]) => part > 0 && part * (steep ? steep(length(gradient) / part) : 1) *
    extinction(first / part, Math.sqrt(Math.max(second / part - (first / part) ** 2, 0))));
}

/** Mean of the field at a depth, by the measure. */
function valueAt(hits, depth) {
  let sum = 0, weight = 0;
  for (const hit of hits) {
    if (depth < hit.start || depth > hit.end) continue;
    const u = (depth - hit.at) / hit.deviation, share = (hit.mass / hit.deviation) * Math.exp(-0.5 * u * u);
    weight += share;
    sum += share * (hit.value + hit.rate * depth);
  }
  return sum / weight;
}

export class Probe {
  /**
   * Probes a ray.
   * parts   [{instances, data: of the field, first, count}]
   * what    {transfer, source: {reference, unit, isMeasure, background}, clip of clip.js}
   * returns {opacity: of the whole ray, value, depth: from the eye in world units; null: nothing is opaque}
   */
  probe(parts, model, ray, { transfer, source, clip }) {
    if (this.of !== transfer) Object.assign(this, { of: transfer, extinction: extinctionIn(lightOf(transfer, source)), steep: steepOf(transfer, source, model) });
    const hits = [];
    for (const part of parts) addHits(hits, model, part, ray, kept(ray, clip));
    if (hits.length === 0) return { opacity: 0, value: null, depth: null };
    // The instances include the extinction of T.
    for (const hit of hits) hit.mass /= model.extinction;
    let from = Math.min(...hits.map(({ start }) => start)), to = Math.max(...hits.map(({ end }) => end));
    let steps = depthsOf(hits, this, from, to, coarse);
    const opacity = -Math.expm1(-steps.reduce((a, b) => a + b, 0)), wanted = -Math.log1p(-opaque);
    if (opacity < opaque) return { opacity, value: null, depth: null };
    let sum = 0;
    for (const count of [coarse, fine]) {
      if (count === fine) steps = depthsOf(hits, this, from, to, fine);
      let n = 0;
      while (n + 1 < count && sum + steps[n] < wanted) sum += steps[n++];
      const step = (to - from) / count;
      [from, to] = [from + n * step, from + (n + 1) * step];
      if (count === fine) from += step * Math.min(Math.max((wanted - sum) / steps[n], 0), 1);
    }
    return { opacity, value: source.reference + source.unit * valueAt(hits, from), depth: from * model.unit };
  }
}
