// fields.js: fields of a compact model as GPU instances.
import { openedModel } from './gaussians.js';
import { chunkField, fileField, rotationAxes } from './vogz.js';

/** Floats per instance of a scalar field: value, change along each own axis, deviation, skewness. */
export const scalarFloats = 6;
/** Of a vector field: value and changes of each component, covariance xx xy xz yy yz zz, deviations. */
export const vectorFloats = 21;

/** Writes Gaussian n of a field in the page's units: the argument of chunkField. */
function setter(out, first, { vector, reference, scale }) {
  const floats = vector ? vectorFloats : scalarFloats;
  return (n, scales, quaternion, { value, deviation, gradient, share }) => {
    const at = (first + n) * floats, axes = rotationAxes(quaternion);
    for (let part = 0; part < value.length; ++part) {
      out[at + 4 * part] = (value[part] - reference) / scale;
      const [gx, gy, gz] = gradient[part];
      for (let k = 0; k < 3; ++k)
        out[at + 4 * part + 1 + k] = ((axes[k][0] * gx + axes[k][1] * gy + axes[k][2] * gz) * scales[k]) / scale;
    }
    const d = deviation.map((one) => one / scale);
    if (!vector) {
      out[at + 4] = d[0], out[at + 5] = share[0];
      return;
    }
    const [xy, xz, yz] = share;
    out.set([d[0] * d[0], xy * d[0] * d[1], xz * d[0] * d[2], d[1] * d[1], yz * d[1] * d[2], d[2] * d[2], ...d], at + 12);
  };
}
const empty = (file, { vector }) => new Float32Array(file.gaussians * (vector ? vectorFloats : scalarFloats));

/**
 * Instances of a field of one level, in the page's units.
 * source  as of openedModel
 * field  place among the model's fields
 * page   {vector, reference, scale}: (value - reference) / scale is what the page has
 */
export async function decodeField(source, field, page) {
  const file = await openedModel(source), out = empty(file, page);
  let first = 0;
  for (const chunk of file.chunks) {
    await chunkField(file, chunk, field, setter(out, first, page));
    first += chunk.count;
  }
  return out;
}

/** The same of a chunk whose field has a file of its own; both are bytes. */
export async function decodeFieldFile(shapes, field, page) {
  const file = await openedModel(shapes), out = empty(file, page);
  await fileField(file, field, page.vector, [page.reference - page.scale, page.reference + page.scale], setter(out, 0, page));
  return out;
}
