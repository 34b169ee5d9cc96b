// transfer.js: transfer functions of values, {colors: [[value, r, g, b], ...], opacity: [[value, opacity], ...],
// unit: unit distance, gradient: [[magnitude, factor], ...] or none}, and the light they give: as vog/value_transfer.h and render/by_value/light_of_moments.cpp.
import { walker } from './colors.js';

const columns = 1024;     // of the table of finish.frag
export const mostOpacity = 0.9999;
const leastShare = 1e-3;  // of the range, below which a measure counts as this share

/** Gradient opacity: factor of extinction by the length of a gradient, ± the source's per unit of the model; null: none. */
export const steepOf = ({ gradient }, { unit }, model) => (gradient ? (slope) => walker(gradient)((slope * unit) / model.unit)[1] : null);

/** Whether opacity steps up to mostOpacity at a value: has_surface() of render/by_value. */
export const hasSurface = ({ opacity }) => opacity.some(([v, a], n) => n > 0 && v === opacity[n - 1][0] && Math.max(a, opacity[n - 1][1]) >= mostOpacity);
export const extinctionOf = (opacity, unit) => -Math.log1p(-Math.max(0, Math.min(mostOpacity, opacity))) / unit;

const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const mix = (a, b, share) => a.map((from, c) => from + share * (b[c] - from));

/** Appends pieces [start, end, light, light] of a function, each linear to a 500th of the light. */
function divide(pieces, light, from, first, to, last, depth = 0) {
  const middle = 0.5 * (from + to), at = light(middle), off = mix(first, last, 0.5).map((v, c) => Math.abs(v - at[c]));
  if (!(Math.max(...off) > 2e-3 * Math.max(...at)) || depth === 9) return void pieces.push([from, to, first, last]);
  divide(pieces, light, from, first, middle, at, depth + 1);
  divide(pieces, light, middle, at, to, last, depth + 1);
}

/** Whether a table follows pieces: between two of its columns light goes up or down, not both by more than a 50th of the most there is. */
function followed(pieces, valueAt) {
  let n = 0;
  for (let column = 0; column + 1 < columns; ++column) {
    const from = valueAt(column / (columns - 1)), to = valueAt((column + 1) / (columns - 1)), seen = [];
    while (n + 1 < pieces.length && pieces[n][1] <= from) ++n;
    for (let m = n; m < pieces.length && pieces[m][0] < to; ++m) {
      const [start, end, first, last] = pieces[m];
      for (const v of [from, to]) seen.push(mix(first, last, clamp((v - start) / (end - start), 0, 1)));
    }
    for (let c = 0; c < 4; ++c) {
      let path = 0;
      for (let k = 1; k < seen.length; ++k) path += Math.abs(seen[k][c] - seen[k - 1][c]);
      if (path - Math.abs(seen.at(-1)[c] - seen[0][c]) > 0.02) return false;
    }
  }
  return true;
}

/**
 * Light per unit of the measure as pieces that are linear in the value, as render/by_value/light_of_moments.cpp makes them. Values are shares of the data's range.
 * source   {reference, unit, isMeasure, background}: the range is reference ± unit; the measure is the value above the background
 * returns  {pieces: [[start, end, light, light]] over its most, most, columns: uniform of finish.frag, exact: for bands narrower than them}
 */
export function lightOf({ colors, opacity, unit }, source) {
  const low = source.reference - source.unit, range = 2 * source.unit, own = (value) => (value - low) / range;
  const empty = source.background ?? 0, least = empty + leastShare * Math.max(Math.abs(low - empty), Math.abs(low + range - empty));
  const light = (share) => {
    const value = low + range * share, shown = source.isMeasure ? Math.max(value, least) : value;
    let s = extinctionOf(walker(opacity)(shown)[1], unit);
    if (source.isMeasure) s = value < empty ? 0 : s / (shown - empty);
    return [...walker(colors)(shown).slice(1), 1].map((c) => c * s);
  };
  const values = [...colors.map(([v]) => own(v)), ...opacity.map(([v]) => own(v)), ...(source.isMeasure ? [own(empty), own(least)] : [])];
  const ends = [...new Set([0, 1, ...values.filter((v) => v > 0 && v < 1)])].sort((a, b) => a - b), pieces = [];
  // Just inside: at a step of the transfer function the ends have other values.
  for (let n = 0; n + 1 < ends.length; ++n) {
    const [from, to] = [ends[n], ends[n + 1]], inside = 1e-9 * (to - from);
    if (Math.fround(to) > Math.fround(from)) divide(pieces, light, from, light(from + inside), to, light(to - inside));
  }
  const most = pieces.reduce((m, [, , a, b]) => Math.max(m, a[3], b[3]), 0) || 1;
  for (const piece of pieces) for (const k of [2, 3]) piece[k] = piece[k].map((v) => v / most);
  let first = clamp(Math.min(own(colors[0][0]), own(opacity[0][0])), 0, 1);
  let last = clamp(Math.max(own(colors.at(-1)[0]), own(opacity.at(-1)[0])), 0, 1);
  if (!(last - first > 1e-5)) [first, last] = [0, 1];
  const margin = 0.05 * (last - first), from = Math.max(first - margin, 0), to = Math.min(last + margin, 1), part = 0.5 / (to - from);
  const [atFirst, atLast] = [0.5 * from, 0.5 * to + 0.5];
  const valueAt = (p) => (p <= atFirst ? 2 * p : p >= atLast ? 1 - 2 * (1 - p) : from + ((to - from) * (p - atFirst)) / (atLast - atFirst));
  return { pieces, most, columns: [from, to, 0.5, part], exact: !followed(pieces, valueAt) };
}

/** Error function: Abramowitz and Stegun 7.1.26, of absolute error below 1.5e-7. */
function erf(x) {
  const t = 1 / (1 + 0.3275911 * Math.abs(x));
  const sum = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
  return Math.sign(x) * (1 - sum * Math.exp(-x * x));
}
/** Share of a normal distribution below u deviations. */
export const below = (u) => 0.5 * (1 + erf(u * Math.SQRT1_2));

/** Mean extinction for the measure 1 of normal distributions (render/device/expected_light.h), by mean and deviation in units of ± the source's. */
export function extinctionIn({ pieces, most }) {
  return (value, deviation) => {
    const mean = clamp(0.5 + 0.5 * value, 0, 1), spread = Math.max(0.5 * deviation, 1e-6), density = (z) => Math.exp(-0.5 * z * z) / Math.sqrt(2 * Math.PI);
    let [low, high] = [0, pieces.length - 1], sum = 0, whole = 0;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (pieces[middle][0] <= mean - 4 * spread) low = middle;
      else high = middle - 1;
    }
    for (; low < pieces.length && (pieces[low][0] - mean) / spread < 4; ++low) {
      const [start, end, first, last] = pieces[low], z0 = (start - mean) / spread, z1 = (end - mean) / spread, mass = below(z1) - below(z0);
      const moment = clamp(((mean - start) * mass + spread * (density(z0) - density(z1))) / (end - start), 0, mass);
      sum += (mass - moment) * first[3] + moment * last[3];
      whole += mass;
    }
    return whole > 0 ? (most * sum) / whole : 0;
  };
}

/** Pieces of at most a 32nd, as vog::over_range divides those of a logarithmic range. */
function divided(points) {
  return points.flatMap((to, n) => {
    if (n === 0) return [to];
    const from = points[n - 1], parts = Math.max(1, Math.ceil((to[0] - from[0]) * 32));
    return Array.from({ length: parts }, (_, k) => (k + 1 === parts ? to : to.map((end, c) => from[c] + (end - from[c]) * ((k + 1) / parts))));
  });
}

/** Transfer function over values, or their logarithms, of a map of shares, {colors, opacity} over [0, 1]: without opacity a ramp, of logarithms of squares. */
export function overRange(map, lower, upper, unit, log = false) {
  const value = (share) => (log ? lower * (upper / lower) ** share : lower + share * (upper - lower));
  const stated = map.opacity && map.opacity.length, pieces = log ? divided : (points) => points;
  const opacity = pieces(stated ? map.opacity : [[0, 0], [1, 1]]).map(([v, a]) => [v, log && !stated ? a * a : a]);
  return {
    name: map.name, unit,
    colors: pieces(map.colors).map(([v, ...rgb]) => [value(v), ...rgb]),
    opacity: opacity.map(([v, a]) => [value(v), a]),
  };
}

/** A transfer function with all its values moved: value -> to(value). */
export function remapped(transfer, to) {
  const move = (points) => points.map(([v, ...rest]) => [to(v), ...rest]);
  return { ...transfer, colors: move(transfer.colors), opacity: move(transfer.opacity) };
}

/** An edited transfer function as the `tf` of requests and files. */
export function transferWord({ name, unit, colors, opacity, gradient }) {
  const values = [...colors, ...opacity].map(([v]) => v), low = Math.min(...values), high = Math.max(...values);
  return { name, domain: [low, low < high ? high : low + 1], unit_distance: unit, colors, opacity, ...(gradient && { gradient_opacity: gradient }) };
}
