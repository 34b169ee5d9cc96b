// gaussians.js: Gaussians of a compact model as GPU instances.
import { chunkShapes, opened } from './vogz.js';

/** Floats per instance: mean x y z, density, three scales, rotation w x y z (splat.vert). */
export const instanceFloats = 11;

/** Compact model of a script element's text, base64, or of the bytes of a file; one that is opened stays as it is. */
export function openedModel(source) {
  if (source instanceof Uint8Array) return opened(source);
  if (typeof source !== 'string') return source;
  const text = atob(source.trim()), bytes = new Uint8Array(text.length);
  for (let n = 0; n < text.length; ++n) bytes[n] = text.charCodeAt(n);
  return opened(bytes);
}

/**
 * Instances of one level or chunk, relative to the model's centre in its unit.
 * source  as of openedModel
 * frame   {center, unit}, world units
 * factor  of density: the extinction
 */
export async function decodeLevel(source, { center, unit }, factor) {
  const file = await openedModel(source), out = new Float32Array(file.gaussians * instanceFloats);
  const corner = center.map((c, axis) => file.origin[axis] - c + file.corner[axis]);
  let first = 0;
  for (const chunk of file.chunks) {
    const at = (n) => (first + n) * instanceFloats;
    await chunkShapes(file, chunk, (n, scales, quaternion, mass) => {
      const i = at(n);
      out[i + 3] = (factor * unit * mass) / scales[0] / scales[1] / scales[2];
      for (let axis = 0; axis < 3; ++axis) out[i + 4 + axis] = scales[axis] / unit;
      out.set(quaternion, i + 7);
    }, (n, axis, mean) => { out[at(n) + axis] = (corner[axis] + mean) / unit; });
    first += chunk.count;
  }
  return out;
}
