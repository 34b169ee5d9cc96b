// handles.js: what can be dragged over the picture by mouse or touch: faces of the clip box, and the light.
import { add, dot, mul, sub } from './vectors.js';
import { axesOf, halfTangent } from './camera.js';
import { isBehind, lightPlace } from './picture/light.js';
import { rayOf } from './picture/probe.js';

const least = 0.01;     // of the model's box, between two faces
const leastSine = 0.12; // between a handle's axis and the view: nearer to it, a pixel is too long a way

const unit = (axis) => [0, 1, 2].map((k) => (k === axis ? 1 : 0));

/** Place on the axis through a point that is nearest to a ray; null where the two are about parallel. */
function nearestOn(axis, point, { origin, direction }) {
  const along = unit(axis), b = dot(along, direction), apart = sub(point, origin), sine2 = 1 - b * b;
  return sine2 < leastSine ** 2 ? null : (b * dot(direction, apart) - dot(along, apart)) / sine2;
}

/** An element of SVG, added to another. */
function added(to, name, attributes) {
  const element = document.createElementNS(to.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  to.append(element);
  return element;
}

export class Handles {
  /**
   * svg   over the picture
   * view  {camera(), box(): {center, half} of the model, clip(): {lower, upper} or null, size(): [width, height] in CSS pixels,
   *       place(event): of a pointer in these, change(clip)}
   */
  constructor(svg, view) {
    this.box = added(svg, 'g', {});
    this.view = view;
    const made = (name, attributes) => added(this.box, name, attributes);
    this.edges = Array.from({ length: 12 }, () => made('line', {}));
    this.handles = [0, 1, 2].flatMap((axis) => [0, 1].map((end) => {
      const dot = made('circle', { class: `dot axis-${'xyz'[axis]}`, r: 6 }), grip = made('circle', { class: 'grip', r: 16 });
      this.attach(grip, axis, end);
      return { axis, end, dot, grip };
    }));
  }

  ends() {
    const clip = this.view.clip(), { center, half } = this.view.box();
    return clip ?? { lower: sub(center, half), upper: add(center, half) };
  }
  /** Middle of a face. */
  middle(axis, end, { lower, upper }) {
    const point = mul(0.5, add(lower, upper));
    point[axis] = (end ? upper : lower)[axis];
    return point;
  }

  attach(grip, axis, end) {
    let held = null;  // {point: middle of the face, from: place on its axis where the pointer went down}
    const along = (event, point) => {
      const [x, y] = this.view.place(event), [width, height] = this.view.size();
      return nearestOn(axis, point, rayOf(this.view.camera(), [x - 0.5, y - 0.5], width, height));
    };
    grip.addEventListener('pointerdown', (event) => {
      const point = this.middle(axis, end, this.ends()), from = along(event, point);
      if (from === null) return;
      held = { point, from };
      grip.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    grip.addEventListener('pointermove', (event) => {
      const to = held && along(event, held.point);
      if (to === null) return;
      const { lower, upper } = this.ends(), { center, half } = this.view.box(), gap = 2 * least * half[axis];
      const value = held.point[axis] + to - held.from, ends = { lower: [...lower], upper: [...upper] };
      if (end) ends.upper[axis] = Math.min(Math.max(value, lower[axis] + gap), center[axis] + half[axis]);
      else ends.lower[axis] = Math.max(Math.min(value, upper[axis] - gap), center[axis] - half[axis]);
      if (ends.lower[axis] < ends.upper[axis]) this.view.change(ends);
    });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
      grip.addEventListener(name, () => { held = null; });
  }

  /** Place in the picture; null behind the eye. */
  project(point) {
    const camera = this.view.camera(), [width, height] = this.view.size(), side = Math.min(width, height);
    const { right, up, forward } = axesOf(camera), from = sub(point, camera.eye), depth = dot(from, forward);
    if (!camera.span && !(depth > 1e-6 * side)) return null;
    const scale = camera.span ? side / camera.span : (0.5 * side) / (halfTangent(camera) * depth);
    return [0.5 * width + scale * dot(from, right), 0.5 * height - scale * dot(from, up)];
  }

  /** shown  whether the box is to be seen */
  show(shown) {
    this.box.toggleAttribute('hidden', !shown);
    if (!shown) return;
    const ends = this.ends(), { half } = this.view.box(), [width, height] = this.view.size(), camera = this.view.camera();
    const corner = (bits) => [0, 1, 2].map((axis) => (bits & (1 << axis) ? ends.upper : ends.lower)[axis]);
    let n = 0;
    for (let axis = 0; axis < 3; ++axis)
      for (let bits = 0; bits < 8; ++bits) {
        if (bits & (1 << axis)) continue;
        const [a, b] = [corner(bits), corner(bits | (1 << axis))].map((point) => this.project(point)), line = this.edges[n++];
        line.toggleAttribute('hidden', !a || !b);
        if (a && b) [['x1', a[0]], ['y1', a[1]], ['x2', b[0]], ['y2', b[1]]].forEach(([name, v]) => line.setAttribute(name, v));
      }
    for (const { axis, end, dot: mark, grip } of this.handles) {
      const point = this.middle(axis, end, ends), at = this.project(point);
      const usable = at && half[axis] > 0 && nearestOn(axis, point, rayOf(camera, [at[0] - 0.5, at[1] - 0.5], width, height)) !== null;
      for (const circle of [mark, grip]) {
        circle.toggleAttribute('hidden', !usable);
        if (usable) circle.setAttribute('cx', at[0]), circle.setAttribute('cy', at[1]);
      }
    }
  }
}

/** A sphere where the first light comes from: in the middle the eye's, at the rim that from behind, which is hollow. */
export class LightHandle {
  /** view  {light(), camera(), size(): [width, height] in CSS pixels, begin(): of a drag, drag(step over the picture)} */
  constructor(svg, view) {
    this.view = view;
    this.circles = [added(svg, 'circle', { class: 'dot light', r: 7 }), added(svg, 'circle', { class: 'grip', r: 16 })];
    const [, grip] = this.circles;
    let last = null;
    grip.addEventListener('pointerdown', (event) => {
      last = [event.clientX, event.clientY];
      grip.setPointerCapture(event.pointerId);
      event.preventDefault();
      view.begin();
    });
    grip.addEventListener('pointermove', ({ clientX, clientY }) => {
      if (!last) return;
      const half = 0.5 * Math.min(...view.size()), step = [(clientX - last[0]) / half, (last[1] - clientY) / half];
      last = [clientX, clientY];
      view.drag(step);
    });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'])
      grip.addEventListener(name, () => { last = null; });
  }

  show(shown) {
    for (const circle of this.circles) circle.toggleAttribute('hidden', !shown);
    if (!shown) return;
    const { view, circles } = this, [width, height] = view.size(), place = lightPlace(view.light(), view.camera());
    const half = 0.5 * Math.min(width, height), [x, y] = place;
    for (const circle of circles) circle.setAttribute('cx', 0.5 * width + half * x), circle.setAttribute('cy', 0.5 * height - half * y);
    circles[0].classList.toggle('behind', isBehind(place));
  }
}
