// light.js: shares of light that reach points of a volume, through what absorbs it on its way (docs/volume_rendering.md, "Shadows and ambient
// occlusion"): on a lattice of cells, as src/render/light has them. Lengths are in the page's units.
import { add, dot, isSame, length, mul, normalized, sub } from '../vectors.js';
import { axesOf } from '../camera.js';
import { instanceFloats } from '../model/gaussians.js';
import { scalarFloats } from '../model/fields.js';
import { extinctionIn, steepOf } from './transfer.js';
import { planesOf } from './clip.js';

const cells = 64;                           // along the longest edge of the model's box
const mostReach = 3, cellVariance = 1 / 12;  // deviations; cells squared, of a cell
const directions = 24;                      // of ambient light
const pairShare = 0.95, mostSkewness = 3;        // NormalPair of render/device/expected_light.h
const halfOpaque = 4, opaqueSteepness = 4;  // optical depth of a cell
const depthCell = cells / 32, thinCell = 0.02;   // of render/device: kDepthCells, in cells; kThinCell
export const towardsLightCells = 2;         // kTowardsLight of render/device/light/light_lattice.h

/**
 * Mean extinctions of values with these moments for the measure 1: less what clear matter beside opaque matter lets pass, and all.
 * cell  measure along a line through a cell of such matter
 */
function meanExtinctions(mean, variance, third, cell, extinction) {
  const deviation = Math.sqrt(variance);
  if (!(variance > 4e-5)) return Array(2).fill(extinction(Math.max(-1, Math.min(1, mean)), deviation));
  const u = Math.max(-mostSkewness, Math.min(mostSkewness, third / (variance * deviation))) / pairShare ** 3, root = Math.hypot(u, 2);
  const of = (sign) => {
    const value = Math.max(-1, Math.min(1, mean + 0.5 * pairShare * deviation * (u + sign * root)));
    return extinction(value, Math.min(Math.sqrt(1 - pairShare ** 2) * deviation, 1 - Math.abs(value)));
  };
  const high = of(1), low = of(-1), share = 0.5 * (1 - u / root), whole = low + share * (high - low);
  const passed = share * Math.exp(-cell * high) + (1 - share) * Math.exp(-cell * low);
  return [cell * whole > thinCell ? -Math.log(Math.max(passed, 1e-30)) / cell : whole, whole];
}

/**
 * Mean extinctions in cubic cells around a model's box, with two empty cells on each side: {sum: [z][y][x], whole: without what clear matter lets pass, size, first: centre of the first cell, edge}.
 * Of each cell the moments of its values, classified as those of a slab.
 * gaussians   {instances, data: of the field}
 * extinction  of extinctionIn
 * factor      of steepOf
 */
export function extinctionLattice({ box, center, unit, cutoff, limits, extinction: perDensity }, { instances, data }, extinction, factor = null) {
  const half = mul(1 / unit, box.half), middle = mul(1 / unit, sub(box.center, center)), edge = (2 * Math.max(...half)) / cells || 1;
  const size = half.map((h) => Math.ceil(((2 * h) / edge) * (1 - 1e-9)) + 4), first = middle.map((m, k) => m - 0.5 * edge * (size[k] - 1));
  const sum = new Float32Array(size[0] * size[1] * size[2]), whole = new Float32Array(sum.length), stride = factor ? 7 : 4, moments = new Float64Array(stride * sum.length), reach = Math.min(cutoff, mostReach), lower = [0, 0, 0], upper = [0, 0, 0];
  let values = new Float32Array(4096);
  for (let i = 0, f = 0; i < instances.length; i += instanceFloats, f += scalarFloats) {
    const [sx, sy, sz, w, x, y, z] = instances.subarray(i + 4, i + instanceFloats), a = (sx / edge) ** 2, b = (sy / edge) ** 2, c = (sz / edge) ** 2;
    const r = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
    const entry = (n, m) => a * r[n] * r[m] + b * r[n + 1] * r[m + 1] + c * r[n + 2] * r[m + 2];
    // Widened by the size of a cell: samples at the centres of cells then vary little.
    const xx = entry(0, 0) + cellVariance, yy = entry(3, 3) + cellVariance, zz = entry(6, 6) + cellVariance;
    const xy = entry(0, 3), xz = entry(0, 6), yz = entry(3, 6), ixx = yy * zz - yz * yz, ixy = xz * yz - xy * zz, ixz = xy * yz - xz * yy;
    const per = 0.5 / (xx * ixx + xy * ixy + xz * ixz), spread = [xx, yy, zz], mean = [0, 1, 2].map((k) => (instances[i + k] - first[k]) / edge);
    for (let k = 0; k < 3; ++k) {
      const side = reach * Math.sqrt(spread[k]);
      lower[k] = Math.max(0, Math.ceil(mean[k] - side)), upper[k] = Math.min(size[k] - 1, Math.floor(mean[k] + side));
    }
    const [fxx, fyy, fzz] = [per * ixx, per * (xx * zz - xz * xz), per * (xx * yy - xy * xy)];
    const [fxy, fxz, fyz] = [2 * per * ixy, 2 * per * ixz, 2 * per * (xy * xz - xx * yz)], [mx, my, mz] = mean;
    const count = (upper[0] - lower[0] + 1) * (upper[1] - lower[1] + 1) * (upper[2] - lower[2] + 1);
    if (count > values.length) values = new Float32Array(2 * count);
    let n = 0, samples = 0;
    for (let k = lower[2]; k <= upper[2]; ++k)
      for (let j = lower[1]; j <= upper[1]; ++j) {
        const dy = j - my, dz = k - mz, rest = fyy * dy * dy + fzz * dz * dz + fyz * dy * dz, slope = fxy * dy + fxz * dz;
        for (let dx = lower[0] - mx; n < values.length && dx <= upper[0] - mx + 1e-3; ++dx) samples += values[n++] = Math.exp(-(dx * (fxx * dx + slope) + rest));
      }
    if (!(samples > 0)) continue;
    const density = (limits[3] * instances[i + 3] * sx * sy * sz) / (perDensity * edge ** 3 * samples);
    // Of the place within the Gaussian a cell knows the mean, and the plane spreads its values by the rest.
    const d = [(sx / edge) * data[f + 1], (sy / edge) * data[f + 2], (sz / edge) * data[f + 3]];
    const [ax, ay, az] = [0, 3, 6].map((k) => r[k] * d[0] + r[k + 1] * d[1] + r[k + 2] * d[2]);
    const tx = 2 * fxx * ax + fxy * ay + fxz * az, ty = fxy * ax + 2 * fyy * ay + fyz * az, tz = fxz * ax + fyz * ay + 2 * fzz * az;
    const spreading = Math.max(data[f + 1] ** 2 + data[f + 2] ** 2 + data[f + 3] ** 2 - ax * tx - ay * ty - az * tz, 0), variance = data[f + 4] ** 2 + spreading, third = data[f + 5] * data[f + 4] ** 3;
    const gradient = [0, 3, 6].map((k) => r[k] * data[f + 1] / sx + r[k + 1] * data[f + 2] / sy + r[k + 2] * data[f + 3] / sz);
    n = 0;
    for (let k = lower[2]; k <= upper[2]; ++k)
      for (let j = lower[1]; j <= upper[1]; ++j) {
        let value = data[f] + (lower[0] - mx) * tx + (j - my) * ty + (k - mz) * tz;
        for (let at = stride * ((k * size[1] + j) * size[0] + lower[0]), end = at + stride * (upper[0] - lower[0]); at <= end; at += stride, value += tx) {
          const part = density * values[n++], square = value * value;
          moments[at] += part;
          moments[at + 1] += part * value;
          moments[at + 2] += part * (square + variance);
          moments[at + 3] += part * (value * (square + 3 * variance) + third);
          for (let c = 0; c < 3 && factor; ++c) moments[at + 4 + c] += part * gradient[c];
        }
      }
  }
  for (let n = 0, m = 0; n < sum.length; ++n, m += stride) {
    const tau = moments[m];
    if (!(tau > 0)) continue;
    const mean = moments[m + 1] / tau, square = moments[m + 2] / tau, share = factor ? factor(Math.hypot(moments[m + 4], moments[m + 5], moments[m + 6]) / tau) : 1;
    [sum[n], whole[n]] = meanExtinctions(mean, Math.max(square - mean * mean, 0), moments[m + 3] / tau - mean * (3 * square - 2 * mean * mean), share * tau * depthCell * edge, extinction).map((value) => share * tau * value);
  }
  return { sum, whole, size, first, edge };
}

/** Empties the cells whose centres a clip cuts off. */
function cut({ sum, whole, size, first, edge }, { center, unit }, clip) {
  for (const [normal, offset] of planesOf(clip)) {
    const gap = dot(normal, add(center, mul(unit, first))) - offset, step = mul(unit * edge, normal);
    for (let n = 0, k = 0; k < size[2]; ++k)
      for (let j = 0; j < size[1]; ++j)
        for (let i = 0; i < size[0]; ++i, ++n) if (gap + i * step[0] + j * step[1] + k * step[2] < 0) sum[n] = whole[n] = 0;
  }
}

/** Optical depths from the centres of cells out of the lattice, by lines that step from layer to layer of cells: depths_towards() of illumination.cpp. */
export function depthsTowards({ sum, size, edge }, towards) {
  const rates = towards.map(Math.abs), axis = rates.indexOf(Math.max(...rates)), along = axis === 0 ? 1 : 0, across = axis === 2 ? 1 : 2;
  const strides = [1, size[0], size[0] * size[1]], count = size[axis], columns = size[along] + 2, rows = size[across] + 2, area = columns * rows;
  const forward = Math.sign(towards[axis]), uStep = towards[along] / rates[axis], vStep = towards[across] / rates[axis], step = (edge * length(towards)) / rates[axis];
  // Layers with an empty cell around each.
  const layers = new Float32Array(area * count), depths = new Float32Array(sum.length), to = new Float32Array(area);
  const each = (n, visit) => {
    for (let row = 1; row + 1 < rows; ++row)
      for (let column = 1, at = n * strides[axis] + (row - 1) * strides[across]; column + 1 < columns; ++column, at += strides[along]) visit(row * columns + column, at);
  };
  for (let n = 0; n < count; ++n) each(n, (cell, at) => { layers[n * area + cell] = sum[at]; });
  for (let n = 0; n < count; ++n) {
    for (let cell = 0; cell < area; ++cell) to[cell] = 0.5 * layers[n * area + cell];
    for (let k = 1, m = n + forward; m >= 0 && m < count; ++k, m += forward) {
      const right = Math.floor(k * uStep), down = Math.floor(k * vStep), u = k * uStep - right, v = k * vStep - down;
      const a = (1 - u) * (1 - v), b = u * (1 - v), c = (1 - u) * v, d = u * v;
      const from = Math.max(0, -right), last = Math.min(columns, columns - 1 - right), lastRow = Math.min(rows, rows - 1 - down);
      if (from >= last || Math.max(0, -down) >= lastRow) break;
      for (let row = Math.max(0, -down); row < lastRow; ++row) {
        const shift = m * area + down * columns + right;
        for (let cell = row * columns + from, end = row * columns + last; cell < end; ++cell) {
          const at = cell + shift;
          to[cell] += a * layers[at] + b * layers[at + 1] + c * layers[at + columns] + d * layers[at + columns + 1];
        }
      }
    }
    each(n, (cell, at) => { depths[at] = step * to[cell]; });
  }
  return depths;
}

/** Shares of opaque matter in cells or beside them: opaque_cells() of illumination.cpp. */
export function opaqueCells({ whole, size, edge }) {
  let most = whole;
  for (let axis = 0, stride = 1; axis < 3; stride *= size[axis++]) {
    const before = most, last = size[axis] - 1;
    most = before.map((value, n) => {
      const place = Math.floor(n / stride) % (last + 1);
      return Math.max(value, place > 0 ? before[n - stride] : 0, place < last ? before[n + stride] : 0);
    });
  }
  return most.map((value) => 1 / (1 + (halfOpaque / Math.max(value * edge, 1e-30)) ** opaqueSteepness));
}

/** LightLattice::inside of render/device/light/light_lattice.h, as Illumination::lattice has it. */
export function insideOf(octaves) {
  let [whole, left] = [0, 0];
  for (let part = 1, n = 0; n < octaves; ++n, part /= 2) [whole, left] = [whole + part, left + part / (1 + 1.5 * part)];
  return whole / left - 1;
}

/** Shares of a light from a direction; octaves of multiple scattering as Wrenninge has them. */
export function directLight(lattice, towards, octaves) {
  const whole = 2 - 2 ** (1 - octaves);
  return depthsTowards(lattice, towards).map((depth) => {
    let passed = 0;
    for (let weight = 1, n = 0; n < octaves; ++n, weight /= 2) passed += weight * Math.exp(-weight * depth);
    return passed / whole;
  });
}

/** A lattice of cells of twice the edge. */
function halved({ sum, size, first, edge }) {
  const half = size.map((count) => Math.ceil(count / 2)), out = new Float32Array(half[0] * half[1] * half[2]);
  for (let n = 0, k = 0; k < size[2]; ++k)
    for (let j = 0; j < size[1]; ++j)
      for (let i = 0; i < size[0]; ++i) out[((k >> 1) * half[1] + (j >> 1)) * half[0] + (i >> 1)] += sum[n++] / 8;
  return { sum: out, size: half, first: first.map((v) => v + 0.5 * edge), edge: 2 * edge };
}

/** Values of the halved lattice in the cells of a lattice, linear between them along each axis in turn. */
function doubled(values, half, size) {
  const now = [...half];
  for (let axis = 0; axis < 3; ++axis) {
    const stride = axis === 0 ? 1 : axis === 1 ? now[0] : now[0] * now[1], last = now[axis] - 1, outer = values.length / (stride * now[axis]);
    const out = new Float32Array(outer * size[axis] * stride);
    for (let o = 0, at = 0; o < outer; ++o)
      for (let n = 0; n < size[axis]; ++n) {
        const place = Math.max(0, Math.min(0.5 * (n - 0.5), last)), low = Math.min(Math.floor(place), Math.max(last - 1, 0)), share = place - low;
        const a = (o * now[axis] + low) * stride, b = a + (last > 0 ? stride : 0);
        for (let k = 0; k < stride; ++k) out[at++] = values[a + k] + share * (values[b + k] - values[a + k]);
      }
    values = out;
    now[axis] = size[axis];
  }
  return values;
}

/** Shares of light from all directions, as evenly as Fibonacci's spiral has them. */
export function ambientLight(lattice) {
  const out = new Float32Array(lattice.sum.length), golden = 0.5 * (1 + Math.sqrt(5));
  for (let n = 0; n < directions; ++n) {
    const z = 1 - (2 * n + 1) / directions, across = Math.sqrt(1 - z * z), angle = (2 * Math.PI * n) / golden;
    const depths = depthsTowards(lattice, [across * Math.cos(angle), across * Math.sin(angle), z]);
    for (let at = 0; at < out.length; ++at) out[at] += Math.exp(-depths[at]) / directions;
  }
  return out;
}
/** The same by cells of twice the edge, in a sixteenth of the time: to 9 steps of 255 at the rim of opaque clouds. */
export function ambientDraft(lattice) {
  const half = halved(lattice);
  return doubled(ambientLight(half), half.size, lattice.size);
}

/** Direction of the world of one along right, up and towards the viewer. */
export function ofView([x, y, z], camera) {
  const { right, up, forward } = axesOf(camera);
  return add(mul(x, right), add(mul(y, up), mul(-z, forward)));
}

/**
 * Lights of a look, [{towards: direction of the world, unit length; 0 0 0: the eye, strength}].
 * Without any the eye with shading by gradients, else the upper left of the view, in few digits for links.
 */
export function lightsOf({ on, lights }, camera) {
  if (lights.length === 0) return [{ towards: on ? [0, 0, 0] : normalized(ofView([-0.6, 0.9, 0.6], camera)).map((v) => Number(v.toFixed(4))), strength: 1 }];
  return lights.map(({ towards, ofCamera, strength }) => ({ towards: length(towards) > 0 ? normalized(ofCamera ? ofView(towards, camera) : towards) : towards, strength }));
}

/** The same lights as directions that cast shadows. */
const directionsOf = (light, camera) => lightsOf(light, camera).map(({ towards }) => (length(towards) > 0 ? towards : mul(-1, axesOf(camera).forward)));

/** Lights that stay where they are while the view turns, of a look that may have none. */
export function fixedLights(light, camera) {
  return light.lights.length > 0 ? light.lights : [{ towards: directionsOf(light, camera)[0], ofCamera: false, strength: 1 }];
}

/** Lights of a look whose first one has other parts. */
export function withFirst({ lights: [first = { ofCamera: false, strength: 1 }, ...others] }, part) {
  return [{ ...first, ...part }, ...others];
}

const rim = 0.9;  // place of a light that comes from behind, from the middle of the picture

/** Place of the sphere that shows the first light's direction (points of camera.js): light_place of apps/viewer. */
export function lightPlace(light, camera) {
  const { right, up, forward } = axesOf(camera), [{ towards }] = lightsOf(light, camera);
  const x = dot(towards, right), y = dot(towards, up), across = Math.hypot(x, y), ahead = -dot(towards, forward);
  const away = across > 0 ? (rim * Math.atan2(across, ahead)) / (Math.PI * across) : 0;
  return across > 0 ? [away * x, away * y] : [0, ahead < 0 ? rim : 0];
}

/** Whether it comes from behind the data. */
export const isBehind = (place) => Math.hypot(...place) > 0.5 * rim;

/** Lights whose first one is dragged by a step over the picture; one at the eye becomes one of the world. */
export function draggedLights(light, camera, step) {
  const [x, y] = lightPlace(light, camera).map((v, k) => v + step[k]), away = Math.hypot(x, y);
  const angle = Math.PI * Math.min(away / rim, 1), across = away > 0 ? Math.sin(angle) / away : 0, to = [across * x, across * y, Math.cos(angle)];
  return withFirst(light, { towards: (light.lights[0]?.ofCamera ? to : ofView(to, camera)).map((v) => Number(v.toFixed(4))) });
}

/** Reached light of the latest picture as a texture on a unit of its own. A light that moves only marches again. */
export class ReachedLight {
  constructor(gl, unit) {
    Object.assign(this, { gl, unit, texture: gl.createTexture(), kept: {} });
  }

  /** What was made of the same things; name: of the result. */
  of(name, things, make) {
    if (!this.kept[name] || !isSame(things, this.kept[name].things)) this.kept[name] = { things, made: make() };
    return this.kept[name].made;
  }

  /**
   * Lattice whose shares the texture has; null: all light arrives.
   * mean  of lightOf
   * what  as of Slabs.add
   */
  update(model, mean, { whole, light, camera, transfer, source, clip, draft }) {
    if (!whole || !(light.shadows || light.occlusion)) return null;
    const cuts = light.clipped ? clip : { box: null, planes: [] };
    const lattice = this.of('lattice', [model, whole.instances, whole.data, transfer, cuts.box, light.clipped && clip.planes], () => {
      const made = extinctionLattice(model, whole, extinctionIn(mean), steepOf(transfer, source, model));
      cut(made, model, cuts);
      return made;
    });
    const towards = light.shadows ? directionsOf(light, camera) : [];
    const direct = towards.map((to, n) => this.of(`direct ${n}`, [lattice, light.scattering, ...to], () => directLight(lattice, to, light.scattering)));
    const known = draft && this.kept.ambient?.things[0] !== lattice ? 'draft' : 'ambient', make = { draft: ambientDraft, ambient: ambientLight }[known];
    const ambient = light.occlusion && this.of(known, [lattice], () => make(lattice));
    const opaque = this.of('opaque', [lattice], () => opaqueCells(lattice));
    this.of('texture', [ambient, opaque, ...direct], () => this.upload(lattice.size, direct.length > 0 ? direct : [null], ambient, opaque));
    return { ...lattice, towards };
  }

  /** Lights one after another along z. */
  upload([width, height, depth], direct, ...parts) {
    const { gl } = this, cells = width * height * depth, texels = new Float32Array(3 * cells * direct.length).fill(1), size = [width, height, depth * direct.length];
    direct.forEach((own, light) => [own, ...parts].forEach((values, part) => {
      if (values) for (let n = 0, at = 3 * cells * light + part; n < cells; ++n, at += 3) texels[at] = values[n];
    }));
    gl.activeTexture(gl.TEXTURE0 + this.unit);
    gl.bindTexture(gl.TEXTURE_3D, this.texture);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGB16F, ...size, 0, gl.RGB, gl.FLOAT, texels);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
    gl.activeTexture(gl.TEXTURE0);
    return true;
  }
}
