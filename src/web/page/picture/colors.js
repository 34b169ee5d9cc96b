// colors.js: transfer functions {name, colors: [[v, r, g, b], ...], opacity: [[v, a], ...]}, piecewise
// linear and constant beyond the ends, as vog::color_at evaluates them.

/** Evaluator of a piecewise linear function; v must not decrease from call to call. */
export function walker(points) {
  let n = 0;
  return (v) => {
    while (n < points.length && v >= points[n][0]) ++n;
    const a = points[Math.max(n - 1, 0)], b = points[Math.min(n, points.length - 1)];
    const share = b[0] > a[0] ? (v - a[0]) / (b[0] - a[0]) : 0;
    return a.map((from, k) => from + (b[k] - from) * share);
  };
}

export function reversed(map) {
  const colors = map.colors.map(([v, ...rgb]) => [1 - v, ...rgb]).reverse();
  return { ...map, colors };
}

/** Colours that fade into the background, as vog::fading: from the first one of a luma of 0.2 on, over [0, 1]. */
export function fading(map) {
  const color = walker(map.colors);
  for (let v = 0; v <= 0.5; v += 1 / 64) {
    const [, r, g, b] = color(v);
    if (0.2126 * r + 0.7152 * g + 0.0722 * b < 0.2) continue;
    const rest = map.colors.filter(([at]) => at > v).map(([at, ...rgb]) => [(at - v) / (1 - v), ...rgb]);
    return v === 0 ? map : { ...map, colors: [[0, r, g, b], ...rest] };
  }
  return map;
}

/** RGBA at V = (i / (count - 1))^power; power 2, for shade.frag, is finer near 0. */
export function sampled(map, count, power) {
  const colors = walker(map.colors);
  const opacity = walker(map.opacity && map.opacity.length ? map.opacity : [[0, 1]]);
  const values = new Float32Array(4 * count);
  for (let i = 0; i < count; ++i) {
    const v = Math.pow(i / (count - 1), power);
    values.set([...colors(v).slice(1), opacity(v)[1]], 4 * i);
  }
  return values;
}
