// likeness.mjs: pictures of V of what a page draws and of the whole model, by elliptical footprints of a pixel's blur, and their PSNR.
const pixelVariance = 1 / 12;  // of a pixel's box

/** V of parts [{instances, first, count}] in a view. */
function pictureOf(parts, model, camera, width, height, exposure) {
  const { right, up, forward } = axesOf(camera), side = Math.min(width, height), out = new Float64Array(width * height);
  const perUnit = camera.span ? side / camera.span : (0.5 * side) / halfTangent(camera);
  for (const { instances, first, count } of parts) {
    for (let n = first, i = n * instanceFloats; n < first + count; ++n, i += instanceFloats) {
      const to = [0, 1, 2].map((k) => model.center[k] + model.unit * instances[i + k] - camera.eye[k]), depth = dot(to, forward);
      if (!camera.span && depth < 1e-3 * model.unit) continue;
      const zoom = perUnit / (camera.span ? 1 : depth), [x, y] = [dot(to, right), dot(to, up)];
      const [sx, sy, sz, w, a, b, c] = instances.subarray(i + 4, i + 11);
      const axes = [[1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)], [2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)],
        [2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)]];
      // Covariance in the picture, pixels.
      let [xx, xy, yy] = [pixelVariance, 0, pixelVariance];
      axes.forEach((axis, k) => {
        const s = [sx, sy, sz][k] * model.unit, away = camera.span ? 0 : dot(axis, forward) / depth;
        const u = s * zoom * (dot(axis, right) - x * away), v = s * zoom * (dot(axis, up) - y * away);
        [xx, xy, yy] = [xx + u * u, xy + u * v, yy + v * v];
      });
      const determinant = xx * yy - xy * xy, column = 0.5 * width + zoom * x, row = 0.5 * height - zoom * y;
      const mass = instances[i + 3] * sx * sy * sz * Math.sqrt(2 * Math.PI) * (model.unit * zoom) ** 2 / Math.sqrt(determinant);
      // Rows within 4 deviations, pixels of a row within 4 of its own middle. From pixel to pixel exp() of a square grows by a factor that
      // itself grows by `turn`: two products each in place of an exponential, away from the middle, where it only shrinks.
      const reach = 4 * Math.sqrt(yy), within = 4 * Math.sqrt(determinant / yy), curve = yy / determinant, turn = Math.exp(-curve);
      for (let r = Math.max(0, Math.ceil(row - reach - 0.5)); r < Math.min(height, row + reach - 0.5); ++r) {
        const dy = row - r - 0.5, middle = column + (xy / yy) * dy - 0.5, peak = mass * Math.exp((-0.5 * dy * dy) / yy);
        const [left, right] = [Math.max(0, Math.ceil(middle - within)), Math.min(width - 1, Math.floor(middle + within))];
        const first = Math.min(right + 1, Math.max(left, Math.ceil(middle)));
        for (const [from, to, step] of [[first, right + 1, 1], [first - 1, left - 1, -1]]) {
          const away = step * (from - middle);
          let value = peak * Math.exp(-0.5 * curve * away * away), factor = Math.exp(-curve * (away + 0.5));
          for (let q = from; step * (to - q) > 0; q += step) {
            out[r * width + q] += value;
            value *= factor;
            factor *= turn;
          }
        }
      }
    }
  }
  return out.map((depth) => -Math.expm1(-exposure * depth));
}

/** PSNR of what is drawn against a whole model, the bytes of a compact file; and the largest V, which a blank picture lacks. */
globalThis.likeness = async (whole) => {
  const { state, page, source } = vog, model = page.models[state.model], { width, height } = picture;
  const parts = source.drawn.parts.map(({ gpu, first, count }) => ({ instances: gpu.instances, first, count }));
  const instances = await decodeLevel(Uint8Array.from(atob(whole), (letter) => letter.charCodeAt(0)), model, model.extinction);
  const of = (list) => pictureOf(list, model, state.camera, width, height, state.exposure);
  const [found, wanted] = [of(parts), of([{ instances, first: 0, count: instances.length / instanceFloats }])];
  const square = found.reduce((sum, v, n) => sum + (v - wanted[n]) ** 2, 0) / found.length;
  return { psnr: Math.min(200, -10 * Math.log10(square)), most: wanted.reduce((a, b) => Math.max(a, b), 0) };
};
