// clip_controls.js: sliders of the clip's box, and a row for each of its planes.
import { dot, length } from './vectors.js';
import { axesOf } from './camera.js';
import { mostOwnPlanes } from './picture/clip.js';
import { numberText } from './quantity.js';

const find = (id) => document.getElementById(id);
const made = (name, attributes, ...children) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
};
const axis = (k, sign) => [0, 1, 2].map((n) => (n === k ? sign : 0));
/** Sides that stay, by their words. */
const sides = Object.fromEntries(['x', 'y', 'z'].flatMap((name, k) => [[`towards ${name}`, axis(k, 1)], [`towards −${name}`, axis(k, -1)]]));
const sideOf = (normal) => Object.keys(sides).find((name) => dot(sides[name], normal) > (1 - 1e-12) * length(normal)) ?? 'tilted';
/** Half the extent of a box {center, half} along a normal. */
const reach = (normal, { half }) => normal.reduce((sum, v, k) => sum + Math.abs(v) * half[k], 0);

export class ClipControls {
  /** change  called with {clip} or {planes} */
  constructor(change) {
    this.change = change;
    this.ends = ['x', 'y', 'z'].map((name) => {
      find('clip-ends').append(made('span', {}, name));
      return ['from', 'to'].map((word, end) => {
        const slider = made('input', { type: 'range', min: 0, max: 1, step: 0.005, value: end, 'aria-label': `Clip ${name} ${word}` });
        slider.addEventListener('input', () => this.setBox());
        find('clip-ends').append(slider);
        return slider;
      });
    });
    this.rows = [];
    find('add-plane').addEventListener('click', () => this.add());
    find('clip-none').addEventListener('click', () =>
      change({ clip: null, planes: this.planes.map((plane) => ({ ...plane, on: false })) }));
  }

  setBox() {
    const { center, half } = this.box;
    const at = (end) => [0, 1, 2].map((k) => center[k] + half[k] * (2 * this.ends[k][end].valueAsNumber - 1));
    const [lower, upper] = [at(0), at(1)];
    if (lower.every((v, k) => v < upper[k])) this.change({ clip: { lower, upper } });
  }

  /** Changes one plane; null: removes it. */
  set(n, part) {
    this.change({ planes: this.planes.flatMap((plane, k) => (k !== n ? [plane] : part ? [{ ...plane, ...part }] : [])) });
  }
  /** A plane through the middle that cuts off the half in front, along the axis nearest to the view. */
  add() {
    const { forward } = axesOf(this.camera), size = forward.map(Math.abs), k = size.indexOf(Math.max(...size));
    const normal = axis(k, Math.sign(forward[k]));
    this.change({ planes: [...this.planes, { normal, offset: dot(normal, this.box.center), on: true }] });
    this.rows.at(-1).place.focus();
  }
  turn(n, side) {
    const { normal: old, offset } = this.planes[n], normal = side === 'view' ? axesOf(this.camera).forward : sides[side];
    if (!normal) return;
    // The other side of the same plane, or a plane through the middle.
    const opposite = dot(normal, old) < (1e-12 - 1) * length(old);
    this.set(n, { normal, offset: opposite ? -offset / length(old) : dot(normal, this.box.center), on: true });
  }
  place(n, share) {
    const { normal } = this.planes[n];
    this.set(n, { offset: dot(normal, this.box.center) + (2 * share - 1) * reach(normal, this.box), on: true });
  }

  row(n) {
    const name = `Plane ${n + 1}`;
    const on = made('input', { type: 'checkbox' }), out = made('output', {});
    const side = made('select', { 'aria-label': `Side of plane ${n + 1} that stays`, title: 'Side that stays' },
                      ...Object.keys(sides).map((word) => made('option', { value: word }, word)),
                      made('option', { value: 'view' }, 'behind, as seen now'), made('option', { value: 'tilted' }, 'tilted'));
    const remove = made('button', { type: 'button', 'aria-label': `Remove plane ${n + 1}`, title: 'Remove' }, '×');
    const place = made('input', { type: 'range', min: 0, max: 1, step: 0.005, 'aria-label': `Place of plane ${n + 1}` });
    on.addEventListener('change', () => this.set(n, { on: on.checked }));
    side.addEventListener('change', () => this.turn(n, side.value));
    remove.addEventListener('click', () => {
      this.set(n, null);
      find('add-plane').focus();
    });
    place.addEventListener('input', () => this.place(n, place.valueAsNumber));
    const all = made('div', { class: 'plane' }, made('label', {}, on, name), out, side, remove, place);
    return { all, on, out, side, place };
  }

  /** box  {center, half} of the shown model */
  show({ clip, planes, camera }, box) {
    Object.assign(this, { planes, camera, box });
    const { center, half } = box;
    this.ends.forEach((pair, k) => pair.forEach((slider, end) => {
      const value = clip ? (end ? clip.upper : clip.lower)[k] : center[k] + (end ? 1 : -1) * half[k];
      slider.value = half[k] > 0 ? 0.5 + (0.5 * (value - center[k])) / half[k] : end;
    }));
    if (this.rows.length !== planes.length) {
      this.rows = planes.map((_, n) => this.row(n));
      find('planes').replaceChildren(...this.rows.map(({ all }) => all));
    }
    planes.forEach(({ normal, offset, on }, n) => {
      const row = this.rows[n], extent = reach(normal, box), side = sideOf(normal), at = numberText(offset / length(normal), (0.01 * extent) / length(normal));
      row.on.checked = on;
      row.side.value = side;
      row.side.lastChild.hidden = side !== 'tilted';
      row.out.textContent = at;
      row.place.value = extent > 0 ? 0.5 + (0.5 * (offset - dot(normal, center))) / extent : 0.5;
      row.place.setAttribute('aria-valuetext', at);
    });
    find('add-plane').disabled = planes.length >= mostOwnPlanes;
  }
}
