// overlay.js: scale bar in world units and the world's axes, drawn over the picture.
import { dot, length, sub } from './vectors.js';
import { axesOf, halfTangent } from './camera.js';
import { numberText } from './quantity.js';

const svg = (name, attributes, parent) => {
  const made = document.createElementNS(parent.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
};

/** Length 1, 2 or 5 times a power of ten, at most `most`. */
export function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * [5, 2, 1].find((m) => m * power <= most * (1 + 1e-9));
}

export class Overlay {
  constructor(bar, axes) {
    [this.bar, this.axes] = [bar, axes];
    this.lines = ['x', 'y', 'z'].map((name) => {
      const group = svg('g', { class: `axis-${name}` }, axes);
      const line = svg('line', { x1: 0, y1: 0 }, group), text = svg('text', { 'text-anchor': 'middle', dy: '.35em' }, group);
      text.textContent = name;
      return { group, line, text };
    });
  }

  /** height, width  of the picture, CSS pixels */
  show(camera, width, height) {
    const side = Math.min(width, height);
    if (!(side > 0)) return;
    // World units a pixel at the centre's depth.
    const across = camera.span || 2 * length(sub(camera.at, camera.eye)) * halfTangent(camera);
    const world = roundLength((across / side) * Math.min(120, 0.3 * width));
    this.bar.style.width = `${(world / across) * side}px`;
    this.bar.textContent = numberText(world);
    this.bar.title = `${numberText(world)} world units at the centre of the view`;
    const { right, up, forward } = axesOf(camera);
    const order = this.lines.map((line, axis) => {
      const unit = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
      const [x, y, depth] = [dot(unit, right), -dot(unit, up), dot(unit, forward)];
      line.line.setAttribute('x2', 20 * x);
      line.line.setAttribute('y2', 20 * y);
      line.text.setAttribute('x', 27 * x);
      line.text.setAttribute('y', 27 * y);
      return [depth, line.group];
    });
    // The nearest last: over the others.
    for (const [, group] of order.sort((a, b) => b[0] - a[0])) this.axes.append(group);
  }
}
