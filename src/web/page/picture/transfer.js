// transfer.js: transfer functions of values, {colors: [[value, r, g, b], ...], opacity: [[value, opacity], ...],
// unit: unit distance}, and the light they give: as vog/value_transfer.h and render/by_value/value_light.cpp.
import { walker } from './colors.js';

const columns = 512, rows = 24, cells = 4096;
export const mostOpacity = 0.9999;
const leastShare = 1e-3;  // of the range, below which a measure counts as this share

/** Edges, in deviations, and masses of bins of a normal distribution. */
const bins = (() => {
  const count = 24, steps = 64, width = 6 / count;
  const density = (z) => Math.exp(-0.5 * z * z) / Math.sqrt(2 * Math.PI);
  const edges = Array.from({ length: count + 1 }, (_, n) => -3 + width * n);
  const masses = edges.slice(0, count).map((from) => {
    let sum = 0;  // Simpson's rule
    for (let k = 0; k <= steps; ++k)
      sum += (k === 0 || k === steps ? 1 : k % 2 ? 4 : 2) * density(from + (width * k) / steps);
    return (sum * width) / (3 * steps);
  });
  return { edges, masses, width };
})();

export const extinctionOf = (opacity, unit) => -Math.log1p(-Math.max(0, Math.min(mostOpacity, opacity))) / unit;

/**
 * Expected light of normal distributions, by mean and deviation.
 * source   {reference, unit, isMeasure}: the data's range is reference ± unit
 * returns  {data: [rows][columns][4], columns, rows, part: uniform of light.vert, most: factor of data}
 */
export function expectedLight(transfer, source) {
  const own = (value) => (value - source.reference) / source.unit;
  const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
  const { colors, opacity } = transfer;
  let low = Math.max(-1, Math.min(own(colors[0][0]), own(opacity[0][0])));
  let high = Math.min(1, Math.max(own(colors.at(-1)[0]), own(opacity.at(-1)[0])));
  if (!(high - low > 2e-6)) [low, high] = [-1, 1];
  const margin = 0.05 * (high - low);
  low = Math.max(-1, low - margin);
  high = Math.min(1, high + margin);
  const perRange = 0.25, perPart = 0.5 / (high - low);
  const position = (v) => (v + 1) * perRange + (clamp(v, low, high) - low) * perPart;
  const atLow = position(low), atHigh = position(high);
  const valueAt = (p) => {
    if (p <= atLow) return -1 + 4 * p;
    if (p >= atHigh) return 1 - 4 * (1 - p);
    return low + ((high - low) * (p - atLow)) / (atHigh - atLow);
  };

  const least = leastShare * Math.max(Math.abs(source.reference - source.unit), Math.abs(source.reference + source.unit));
  const integral = new Float64Array(4 * (cells + 1));
  const colorAt = walker(colors), opacityAt = walker(opacity);
  for (let n = 0; n < cells; ++n) {
    const from = valueAt(n / cells), to = valueAt((n + 1) / cells);
    const value = source.reference + source.unit * 0.5 * (from + to);
    let s = extinctionOf(opacityAt(value)[1], transfer.unit) * (to - from);
    if (source.isMeasure) s = value > 0 ? s / Math.max(value, least) : 0;
    const [, r, g, b] = colorAt(value);
    [r * s, g * s, b * s, s].forEach((light, c) => { integral[4 * n + 4 + c] = integral[4 * n + c] + light; });
  }
  const integralAt = (v, out) => {
    const at = clamp(position(v), 0, 1) * cells, cell = Math.min(Math.floor(at), cells - 1), share = at - cell;
    for (let c = 0; c < 4; ++c)
      out[c] = integral[4 * cell + c] + share * (integral[4 * cell + 4 + c] - integral[4 * cell + c]);
  };

  const data = new Float32Array(4 * rows * columns);
  let before = new Float64Array(4), after = new Float64Array(4), most = 0;
  const sum = new Float64Array(4);
  for (let row = 0; row < rows; ++row) {
    const deviation = (row / (rows - 1)) ** 3;
    for (let column = 0; column < columns; ++column) {
      const at = column / (columns - 1), mean = valueAt(at);
      let weight = 0;
      sum.fill(0);
      const add = (from, to, mass) => {
        weight += mass;
        for (let c = 0; c < 4; ++c) sum[c] += (mass * (after[c] - before[c])) / (to - from);
      };
      if (row === 0) {
        // Of one value: the mean over half a column on either side.
        const from = valueAt(Math.max(at - 0.5 / (columns - 1), 0)), to = valueAt(Math.min(at + 0.5 / (columns - 1), 1));
        integralAt(from, before);
        integralAt(to, after);
        add(from, to, 1);
      } else {
        let from = clamp(mean + bins.edges[0] * deviation, -1, 1);
        integralAt(from, before);
        for (let n = 0; n < bins.masses.length; ++n) {
          const to = clamp(mean + bins.edges[n + 1] * deviation, -1, 1);
          integralAt(to, after);
          if (to > from) add(from, to, (bins.masses[n] * (to - from)) / (bins.width * deviation));
          from = to;
          [before, after] = [after, before];
        }
      }
      for (let c = 0; c < 4; ++c) {
        const light = weight > 0 ? sum[c] / weight : 0;
        data[4 * (row * columns + column) + c] = light;
        most = Math.max(most, light);
      }
    }
  }
  // Shares of the largest: what 16-bit floats hold.
  if (most > 0) for (let n = 0; n < data.length; ++n) data[n] /= most;
  return { data, columns, rows, part: [low, high, perRange, perPart], most };
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

/** The JSON that `vog render --tf` reads. */
export function transferJson(transfer) {
  const values = [...transfer.colors, ...transfer.opacity].map(([v]) => v);
  const domain = [Math.min(...values), Math.max(...values)];
  if (!(domain[1] > domain[0])) domain[1] = domain[0] + 1;
  return JSON.stringify({
    name: transfer.name, domain, unit_distance: transfer.unit, colors: transfer.colors, opacity: transfer.opacity,
  }, null, 1);
}
