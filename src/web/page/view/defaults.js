// defaults.js: what `vog page` writes into a page, made here for a model that is nothing but an address: view, extinction, ranges and unit
// distance, from the model's own description and its coarsest chunk. As src/data/views/camera.cpp, src/shade and src/render/picture.
import { add, cross, dot, mul, normalized, sub } from '../vectors.js';
import { turnedUpright } from '../camera.js';
import { walker } from '../picture/colors.js';
import { instanceFloats } from '../model/gaussians.js';
import { varianceWithin } from '../model/vogz.js';
import { erf } from '../picture/transfer.js';
import { areNumbers, isObject, refuse } from '../stream/rows.js';

const azimuth = 0.6, elevation = 0.35, fov = 38.5800924383775, fitShare = 0.95;  // the view `paper`
const mapSize = 256;                                                             // pixels of the picture that is measured
const mostOutside = 1.05, steps = 24;                                            // fit() of camera.cpp
const targetDepth = 4, leastLight = 0.4, mostLight = 0.55, farthest = 2, rim = 0.05, shown = 0.02;

// --- Views. ---

/** Middles of the ends of some numbers. */
const middle = (values) => 0.5 * (Math.min(...values) + Math.max(...values));

/** Target and distance from which the points of a hull fill a square picture; about: the target, or null. */
function fit(hull, { right, up, forward }, about) {
  const slope = fitShare * Math.tan((0.5 * fov * Math.PI) / 180);
  let target = about ?? [0, 1, 2].map((k) => middle(hull.map((point) => point[k]))), distance = 0;
  const ends = [right, up].map((across) => {
    let low = -Infinity, high = -Infinity;
    for (const point of hull) {
      const at = sub(point, target), along = dot(at, forward), aside = dot(at, across);
      high = Math.max(high, aside - slope * along);
      low = Math.max(low, -aside - slope * along);
      distance = Math.max(distance, -mostOutside * along);
    }
    return [low, high, about ? 0 : 0.5 * (high - low)];
  });
  for (const [low, high, shift] of ends) distance = Math.max(distance, (high - shift) / slope, (low + shift) / slope);
  let [x, y] = ends.map(([, , shift]) => shift);
  for (let step = 0; !about && step < steps; ++step) {
    const moved = add(target, add(mul(x, right), mul(y, up)));
    const seen = hull.map((point) => {
      const at = sub(point, moved), depth = dot(at, forward) + distance;
      return [dot(at, right) / depth, dot(at, up) / depth];
    });
    x += middle(seen.map(([one]) => one)) * distance, y += middle(seen.map(([, one]) => one)) * distance;
  }
  target = add(target, add(mul(x, right), mul(y, up)));
  return { target, distance };
}

/** First view of a model, as a request's camera. */
function firstCamera({ up: given, front, hull }, { center, half }) {
  const up = given ? normalized(given) : [0, 1, 0], [a, b] = [[1, 0, 0], [0, 0, 1]].map((v) => turnedUpright(v, up));
  const level = add(mul(Math.cos(azimuth), a), mul(Math.sin(azimuth), b));
  const toEye = front ? normalized(front) : add(mul(Math.cos(elevation), level), mul(Math.sin(elevation), up));
  const forward = mul(-1, toEye), top = Math.abs(dot(toEye, up)) < 1 - 1e-9 ? up : b, right = normalized(cross(forward, top));
  const corners = Array.from({ length: 8 }, (_, n) => [0, 1, 2].map((k) => center[k] + (n & (1 << k) ? 1 : -1) * half[k]));
  const { target, distance } = fit(hull ?? corners, { right, up: cross(right, forward), forward }, hull ? null : center);
  return { eye: add(target, mul(distance, toEye)), look_at: target, up: top, fov_degrees: fov };
}

// --- Descriptions. ---

/** Share of a normal distribution's mass within a cutoff. */
const massWithin = (k) => erf(k / Math.SQRT2) - Math.sqrt(2 / Math.PI) * k * Math.exp(-0.5 * k * k);

function fieldOf({ name, kind, unit, lower, upper, spread, background = 0 }) {
  const vector = kind === 'vector', half = 0.5 * (upper - lower), [low, , high] = spread ?? [lower, , upper];
  const [reference, scale] = vector ? [0, upper > 0 ? upper : 1] : half > 0 ? [lower + half, half] : [lower, Math.max(Math.abs(lower), 1e-300) * 1e-3];
  // As value_scale() of choose_transfer.cpp.
  const log = background === 0 && low > 0 && high >= 10 * low, least = log ? Math.max(low, high / 1e4) : low;
  const values = least < high ? [least, high] : high === 0 ? [0, 1] : [Math.min(0, high), Math.max(0, high)];
  const whole = { linear: values, log: values[0] > 0 ? values : undefined, isLog: false };
  return {
    name, unit, vector, lower, upper, reference, scale, isMeasure: kind === 'measure', background, values, log, unitDistance: 1, spread,
    ranges: vector ? {} : { '': { maximum: whole } },
  };
}

/** A model's entry in the page of its description; numbers that its coarsest chunk has follow by measure(). */
function entryOf({ name, cutoff, origin, fields = [], box, ends, up, front, hull }, limits) {
  if (!(cutoff > 0 && cutoff <= 8)) refuse(`${name}: cutoff`, cutoff, 'above 0, at most 8');
  if (!areNumbers(origin, 3)) refuse(`${name}: origin`, origin, 'three numbers');
  for (const [key, list] of Object.entries({ up: up && [up], front: front && [front], hull, box }))
    if (list && !(Array.isArray(list) && list.every((one) => areNumbers(one, 3)))) refuse(`${name}: ${key}`, list, 'three numbers each');
  if (!Array.isArray(fields) || !fields.every((field) => isObject(field) && areNumbers([field.lower, field.upper, ...(field.spread ?? [])], field.spread ? 5 : 2)))
    refuse(`${name}: fields`, fields, 'names, units and ranges');
  const corners = areNumbers(ends, 6) ? [ends.slice(0, 3), ends.slice(3)].map((corner) => add(origin, corner)) : [[-1, -1, -1], [1, 1, 1]];
  const [lower, upper] = box ?? corners;
  const half = mul(0.5, sub(upper, lower)), center = add(lower, half), radius = Math.hypot(...half) || 1;
  const variance = varianceWithin(cutoff), mass = (2 * Math.PI) ** 1.5 * massWithin(cutoff);
  const limitsOf = ([least, sampled]) => [least / variance, sampled / variance, variance, mass];
  return {
    name, center, unit: radius, cutoff, limits: limitsOf(limits[0]), subframeLimits: limitsOf(limits[1]), box: { center, half, radius },
    extinction: 1, isMeasured: false, lowColumn: 0, mostColumn: 0, logColumn: false, fields: fields.map(fieldOf), levels: [],
  };
}

/**
 * The page of models that are nothing but an address.
 * given         {maps, map, slabs, leastColumn, lightWeights, limits: squares of the least and the sampled deviation, pixels: of whole
 *               pictures and of sub-frames}
 * descriptions  of the models, with `ends` where they may have no box
 * site          of Site
 */
export function pageOf(given, descriptions, { steps: areSteps, ...site }) {
  const models = descriptions.map((description) => entryOf(description, given.limits)), [first] = descriptions;
  return {
    title: models[0].name, picture: { camera: firstCamera(first, models[0].box), light_weights: given.lightWeights }, upright: first.up ?? [0, 1, 0],
    chosenView: false, systemBackground: false, background: [0, 0, 0, 1], leastColumn: given.leastColumn, maps: [...given.maps], map: given.map,
    slabs: given.slabs, steps: areSteps, site, models, cameras: descriptions.map((one, n) => firstCamera(one, models[n].box)),
  };
}

// --- Measures of pictures. ---

/** Value of nearest rank of sorted numbers. */
const percentile = (sorted, share) => sorted[Math.max(Math.ceil(share * sorted.length), 1) - 1];
const sortedOf = (values) => Float32Array.from(values).sort();
const crowdBelow = (sorted, high) => sorted.length > 0 && percentile(sorted, 0.5) < high / 4;

/** Extinction of optical depths of extinction 1 under a map, as picture_extinction() of exposure.cpp. */
function extinctionOf(depths, map) {
  if (depths.length === 0) return 1;
  const usual = targetDepth / percentile(depths, 0.99), scaled = depths.map((depth) => depth * usual), bits = new Uint32Array(scaled.buffer);
  const bins = new Map();
  scaled.forEach((depth, n) => {
    const bin = bins.get(bits[n] >>> 18) ?? bins.set(bits[n] >>> 18, { sum: 0, count: 0 }).get(bits[n] >>> 18);
    bin.sum += depth, ++bin.count;
  });
  const light = (factor) => {
    const color = walker(map.colors);
    let lit = 0, seen = 0;
    for (const { sum, count } of bins.values()) {
      const v = -Math.expm1((-factor * sum) / count), opacity = Math.min(v / rim, 1), pixels = count * Math.min(opacity / shown, 1), [, r, g, b] = color(v);
      lit += pixels * opacity * (0.2126 * r + 0.7152 * g + 0.0722 * b), seen += pixels;
    }
    return lit / seen;
  };
  const first = light(1), isDark = first < leastLight;
  if (first >= leastLight && first <= mostLight) return usual;
  let inside = isDark ? farthest : -farthest, outside = 0;
  for (let step = 0; step < 32; ++step) {
    const exponent = 0.5 * (inside + outside), mean = light(2 ** exponent);
    if (isDark ? mean >= leastLight : mean <= mostLight) inside = exponent;
    else outside = exponent;
  }
  return usual * 2 ** inside;
}

/** Scales of values, as fitted_scale() of color_scale.cpp. */
function scalesOf(values) {
  const sorted = sortedOf(values.filter(Number.isFinite)), above = sorted.filter((v) => v > 0);
  if (sorted.length === 0) return null;
  const ends = (all, isLog) => {
    const high = percentile(all, 0.99), low = Math.max(percentile(all, 0.01), isLog ? high / 1e4 : -Infinity);
    if (low < high) return [low, high];
    const margin = low !== 0 ? 0.01 * Math.abs(low) : 1;
    return isLog ? [low / 2, high * 2] : [low - margin, high + margin];
  };
  return {
    linear: ends(sorted, false), log: above.length > 0 ? ends(above, true) : undefined,
    isLog: sorted[0] >= 0 && above.length > 0 && crowdBelow(above, percentile(above, 0.99)),
  };
}

/** Sums of the first view in a small picture. */
function sumsOfFirst(renderer, parts, model, camera, field, part) {
  renderer.choose('measure');
  renderer.resize(mapSize, mapSize);
  const { eye, look_at: at, up } = camera;
  renderer.addSums(parts, model, { eye, at, up, fov, span: 0 }, { field, part, clip: null });
  return renderer.read(0, 0, mapSize, mapSize);
}

/** Sets extinction, columns and unit distances of an entry by its coarsest chunk, whose instances have the extinction 1. */
function measure(renderer, model, camera, instances, map) {
  const gpu = renderer.upload(instances), sums = sumsOfFirst(renderer, [{ gpu, first: 0, count: gpu.count }], model, camera, null, '');
  renderer.release(gpu);
  const depths = sortedOf(sums.filter((v, n) => n % 4 === 0 && v > 0)), largest = depths.at(-1) ?? 0;
  model.extinction = extinctionOf(depths, map);
  // As automatic_scale() of color_scale.cpp.
  const faint = depths.length > 0 ? percentile(depths, 0.05) : 0;
  Object.assign(model, {
    isMeasured: true, lowColumn: Math.max(Math.min(faint, largest / 10), largest / 1e4), mostColumn: largest, logColumn: crowdBelow(depths, largest),
  });
  let mass = 0;
  for (let i = 0; i < instances.length; i += instanceFloats) mass += instances[i + 3] * instances[i + 4] * instances[i + 5] * instances[i + 6];
  mass *= model.limits[3] * model.unit ** 2;
  for (const field of model.fields) if (!field.vector) field.unitDistance = unitDistanceOf(field, mass, model.box);
}

/** As map_unit_distance() of choose_transfer.cpp. */
function unitDistanceOf({ values: [low, high], log, spread, lower, upper, isMeasure, background }, mass, { half, radius }) {
  const [x, y, z] = mul(2, half), silhouette = 0.5 * (x * y + y * z + z * x), at = spread ? spread[1] : 0.5 * (lower + upper);
  const share = Math.max(0, Math.min(1, log ? Math.log(at / low) / Math.log(high / low) : (at - low) / (high - low)));
  const unit = (Math.max(log ? share * share : share, 0.1) * (isMeasure ? mass / (at - background) : mass)) / silhouette / 2;
  return Number(unit > 0 && Number.isFinite(unit) ? unit.toPrecision(2) : (0.02 * radius).toPrecision(4));
}

/** Sets the ranges of the mean and the deviation of a field's part in the first view. */
function measureField(renderer, model, camera, parts, field, part) {
  const sums = sumsOfFirst(renderer, parts, model, camera, field, part), { reference, scale } = model.fields[field];
  let most = 0;
  for (let n = 0; n < sums.length; n += 4) most = Math.max(most, sums[n]);
  const mean = [], deviation = [], isMagnitude = part === 'magnitude';
  for (let n = 0; n < sums.length; n += 4) {
    const [column, first, second] = sums.subarray(n, n + 3);
    if (!(column > 0 && column >= 1e-3 * most)) continue;
    const at = first / column, spread = Math.sqrt(Math.max(second / column - (isMagnitude ? 0 : at * at), 0));
    mean.push(isMagnitude ? scale * spread : reference + scale * at);
    deviation.push(scale * spread);
  }
  model.fields[field].ranges[part] = { ...model.fields[field].ranges[part], mean: scalesOf(mean), deviation: scalesOf(deviation) };
}

/** Measures a Viewer's model by its coarsest chunk, whose instances get its extinction; steps in time share that of the first one. */
export function measureModel(view, n, instances) {
  const { models, steps, cameras, maps, map } = view.page, entry = models[n], one = models.find(({ isMeasured }) => steps && isMeasured);
  if (one) {
    const { extinction, lowColumn, mostColumn, logColumn } = one;
    Object.assign(entry, { extinction, lowColumn, mostColumn, logColumn, isMeasured: true });
    entry.fields.forEach((field, k) => { field.unitDistance = one.fields[k]?.unitDistance ?? 1; });
  } else {
    measure(view.renderer, entry, cameras[n], instances, maps.find(({ name }) => name === map));
  }
  for (let i = 3; i < instances.length; i += instanceFloats) instances[i] *= entry.extinction;
  view.automatic = view.drawn = null;
  view.tell.measured();
}

/** Measures what a Viewer's quantity needs, unless that has been. */
export function measureShown(view, parts) {
  const { show, field, part, model } = view.state;
  if ((show !== 'mean' && show !== 'deviation') || parts.length === 0 || view.model.fields[field].ranges[part]?.mean) return;
  measureField(view.renderer, view.model, view.page.cameras[model], parts, field, part);
  view.drawn = null;
  view.tell.shown();
}
