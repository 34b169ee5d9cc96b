// visibility.js: how much of a place is seen through the rest of a model, from its coarsest chunk: what is seen comes first (cut.js).
// The Gaussians' extinction is summed up in the cells of a small lattice, along which a ray is followed through each cell.
import { add, dot, length, mul, sub } from '../vectors.js';
import { kept } from '../picture/clip.js';
import { instanceFloats } from '../model/gaussians.js';
import { scalarFloats } from '../model/fields.js';

const cells = 20, steps = 40;  // along each axis of the lattice; along a ray
// What is seen of a place is a mean of this order over its mass: near the largest, so that a rim counts, less so its last hair.
const order = 6;
const least = 1e-6;            // visibility that still tells two chunks apart

/** Extinction of a model's coarsest chunk in cells of its box. */
export class Visibility {
  /**
   * model       of the page: {center, unit}
   * box         {center, half}, world units
   * instances   of gaussians.js
   * extinction  (n): of Gaussian n, over that in T
   */
  constructor(model, box, instances, extinction) {
    this.model = model;
    this.lower = this.inside(sub(box.center, box.half));
    this.size = box.half.map((h) => Math.max((2 * h) / model.unit, 1e-12));
    this.sums = new Float32Array(cells ** 3);
    const volume = this.size.reduce((a, s) => (a * s) / cells, 1);
    for (let n = 0, i = 0; i < instances.length; ++n, i += instanceFloats)
      this.addGaussian(instances, i, extinction(n) / volume);
  }

  /** The same of a field's values: data of fields.js, and expected extinction by value and deviation. */
  static ofValues(model, box, instances, data, extinction) {
    return new Visibility(model, box, instances, (n) => extinction(data[n * scalarFloats], data[n * scalarFloats + 4]) / model.extinction);
  }

  inside(p) { return mul(1 / this.model.unit, sub(p, this.model.center)); }
  cellOf(p) {
    let cell = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const at = Math.floor(((p[axis] - this.lower[axis]) / this.size[axis]) * cells);
      if (!(at >= 0 && at <= cells)) return -1;
      cell = cell * cells + Math.min(at, cells - 1);
    }
    return cell;
  }

  /** Six points have a Gaussian's mass, mean and covariance: at sqrt(3) deviations along each axis. */
  addGaussian(instances, i, factor) {
    const [density, sx, sy, sz, w, x, y, z] = instances.subarray(i + 3, i + 11), at = [0, 0, 0];
    const axes = [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
    const share = (factor * density * sx * sy * sz * (2 * Math.PI) ** 1.5) / 6, scales = [sx, sy, sz];
    for (let n = 0; n < 6; ++n) {
      const k = n >> 1, reach = (n & 1 ? Math.sqrt(3) : -Math.sqrt(3)) * scales[k];
      for (let axis = 0; axis < 3; ++axis) at[axis] = instances[i + axis] + reach * axes[k][axis];
      const cell = this.cellOf(at);
      if (cell >= 0) this.sums[cell] += share;
    }
  }

  /** Optical depth of a ray from one depth to another, page units. */
  depthOf(origin, direction, from, to) {
    for (let axis = 0; axis < 3; ++axis) {
      const a = (this.lower[axis] - origin[axis]) / direction[axis], b = (this.lower[axis] + this.size[axis] - origin[axis]) / direction[axis];
      if (Number.isNaN(a) || Number.isNaN(b)) continue;  // along a face
      from = Math.max(from, Math.min(a, b));
      to = Math.min(to, Math.max(a, b));
    }
    if (!(from < to)) return 0;
    const step = (to - from) / steps, at = [0, 0, 0];
    let sum = 0;
    for (let n = 0; n < steps; ++n) {
      for (let axis = 0; axis < 3; ++axis) at[axis] = origin[axis] + (from + (n + 0.5) * step) * direction[axis];
      const cell = this.cellOf(at);
      if (cell >= 0) sum += this.sums[cell];
    }
    return sum * step;
  }

  /**
   * Finds what a view shows of each cell: exp(-T), T the least optical depth of the rays through it and through the cells around: a
   * rim may be thinner than a cell.
   * view     of cut.js's viewOf
   * clip     what is drawn of the model (clip.js)
   * inFront  only what lies between the cell and the eye hides it
   */
  look({ eye, forward, parallel }, clip, inFront) {
    const { unit, center } = this.model, edge = mul(1 / cells, this.size), reach = 0.5 * length(edge), depths = new Float32Array(cells ** 3);
    for (let x = 0, cell = 0; x < cells; ++x) for (let y = 0; y < cells; ++y) for (let z = 0; z < cells; ++z, ++cell) {
      const point = [x, y, z].map((n, k) => center[k] + unit * (this.lower[k] + (n + 0.5) * edge[k]));
      const along = sub(point, eye), direction = parallel ? forward : mul(1 / (length(along) || 1), along), depth = dot(along, direction);
      const origin = parallel ? sub(point, mul(depth, direction)) : eye, [from, to] = kept({ origin, direction }, clip);
      const end = inFront ? Math.min(to / unit, depth / unit - reach) : to / unit;
      depths[cell] = this.depthOf(this.inside(origin), direction, from / unit, end);
    }
    this.shown = leastAround(depths).map((depth, cell) => this.sums[cell] * Math.exp(-order * depth));
  }

  /** Share of a change in a box that the picture shows, 0 to 1. */
  of({ center, half }) {
    const [first, last] = [sub(center, half), add(center, half)].map((p) => sub(this.inside(p), this.lower).map((at, k) =>
      Math.max(0, Math.min(cells - 1, Math.floor((at / this.size[k]) * cells)))));
    let all = 0, shown = 0;
    for (let x = first[0]; x <= last[0]; ++x) for (let y = first[1]; y <= last[1]; ++y)
      for (let z = first[2], cell = (x * cells + y) * cells + z; z <= last[2]; ++z, ++cell) {
        all += this.sums[cell];
        shown += this.shown[cell];
      }
    return all > 0 ? Math.max(least, (shown / all) ** (1 / order)) : 1;
  }
}

/** Of each cell the least of the numbers of it and the 26 cells around it. */
function leastAround(numbers) {
  for (const stride of [1, cells, cells * cells]) {
    numbers = numbers.map((number, cell) => {
      const at = Math.floor(cell / stride) % cells;
      return Math.min(number, at > 0 ? numbers[cell - stride] : number, at + 1 < cells ? numbers[cell + stride] : number);
    });
  }
  return numbers;
}
