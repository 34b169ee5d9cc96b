// editor.js: editor of a transfer function of values: histogram of the field, curve of opacity with points to drag,
// undo and redo.
import { walker } from './picture/colors.js';
import { numberText } from './quantity.js';

const reach = 9;  // CSS pixels within which a point is grabbed
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

/** Values at the editor's ends: the field's range and the points'. */
function domainOf(transfer, source) {
  const values = [...transfer.colors, ...transfer.opacity].map(([v]) => v);
  const low = Math.min(source.lower, ...values), high = Math.max(source.upper, ...values);
  return high > low ? [low, high] : [low, low + 1];
}

/** A transfer function with all its values moved: value -> to(value). */
export function remapped(transfer, to) {
  const move = (points) => points.map(([v, ...rest]) => [to(v), ...rest]);
  return { ...transfer, colors: move(transfer.colors), opacity: move(transfer.opacity) };
}

/** Opacity curves to start from, over [lower, upper]. */
export const presets = {
  Ramp: (lower, upper) => [[lower, 0], [upper, 1]],
  'Upper half': (lower, upper) => [[lower, 0], [0.5 * (lower + upper), 0], [upper, 1]],
  Bands: (lower, upper) => [0.15, 0.4, 0.65].flatMap((at) => {
    const v = (share) => lower + share * (upper - lower);
    return [[v(at - 0.03), 0], [v(at), 0.8], [v(at + 0.03), 0]];
  }),
  Surface: (lower, upper) => {
    const at = lower + 0.3 * (upper - lower), width = 0.01 * (upper - lower);
    return [[lower, 0], [at - width, 0], [at, 0.99], [upper, 0.99]];
  },
};

export class Editor {
  /** change  called with an edited transfer function */
  constructor(canvas, change) {
    this.canvas = canvas;
    this.change = change;
    this.chosen = 0;    // index of a point of opacity
    this.past = [];
    this.future = [];
    this.transfer = null;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, () => { this.held = false; });
    canvas.addEventListener('dblclick', (event) => this.remove(this.near(event)));
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  /** Shows a transfer function over a field's histogram. */
  show(transfer, source) {
    if (this.source && this.source !== source) [this.past, this.future] = [[], []];
    [this.transfer, this.source] = [transfer, source];
    this.chosen = clamp(this.chosen, 0, transfer.opacity.length - 1);
    this.draw();
  }

  /** Changes the transfer function; `one` edits in a row are undone at once. */
  edit(transfer, one = false) {
    if (!one) this.remember();
    this.future = [];
    this.change(transfer);
  }
  remember() {
    this.past.push(this.transfer);
    if (this.past.length > 100) this.past.shift();
  }
  undo() {
    if (this.past.length === 0) return;
    this.future.push(this.transfer);
    this.change(this.past.pop());
  }
  redo() {
    if (this.future.length === 0) return;
    this.past.push(this.transfer);
    this.change(this.future.pop());
  }

  size() { return [this.canvas.clientWidth || 220, this.canvas.clientHeight || 96]; }
  place([value, opacity]) {
    const [width, height] = this.size(), [low, high] = domainOf(this.transfer, this.source);
    return [((value - low) / (high - low)) * width, (1 - opacity) * (height - 8) + 4];
  }
  at(event) {
    const box = this.canvas.getBoundingClientRect(), [low, high] = domainOf(this.transfer, this.source);
    const opacity = 1 - (event.clientY - box.top - 4) / (box.height - 8);
    return [low + clamp((event.clientX - box.left) / box.width, 0, 1) * (high - low), clamp(opacity, 0, 1)];
  }
  /** Point under the pointer; -1: none. */
  near(event) {
    const box = this.canvas.getBoundingClientRect();
    const distances = this.transfer.opacity.map((point) => {
      const [x, y] = this.place(point);
      return Math.hypot(x - event.clientX + box.left, y - event.clientY + box.top);
    });
    const least = Math.min(...distances);
    return least <= reach ? distances.indexOf(least) : -1;
  }

  down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.remember();
    this.held = true;
    this.chosen = this.near(event);
    if (this.chosen < 0) {
      const point = this.at(event), { opacity } = this.transfer;
      this.chosen = opacity.filter(([v]) => v <= point[0]).length;
      this.edit({ ...this.transfer, opacity: opacity.toSpliced?.(this.chosen, 0, point) ??
        [...opacity.slice(0, this.chosen), point, ...opacity.slice(this.chosen)] }, true);
    }
    this.draw();
  }
  move(event) {
    if (!this.held) return;
    const [value, opacity] = this.at(event);
    this.set(this.chosen, value, opacity);
  }
  /** Moves a point between its neighbours. */
  set(n, value, opacity) {
    const points = this.transfer.opacity.map((point) => [...point]);
    const low = points[n - 1]?.[0] ?? -Infinity, high = points[n + 1]?.[0] ?? Infinity;
    points[n] = [clamp(value, low, high), clamp(opacity, 0, 1)];
    this.edit({ ...this.transfer, opacity: points }, true);
  }
  remove(n) {
    const { opacity } = this.transfer;
    if (n < 0 || opacity.length < 2) return;
    this.edit({ ...this.transfer, opacity: opacity.filter((_, k) => k !== n) });
  }
  key(event) {
    const [value, opacity] = this.transfer.opacity[this.chosen], [low, high] = domainOf(this.transfer, this.source);
    const step = (high - low) / (event.shiftKey ? 20 : 100), count = this.transfer.opacity.length;
    const moves = {
      ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, 0.02], ArrowDown: [0, -0.02],
    };
    if (moves[event.key]) {
      this.remember();
      this.set(this.chosen, value + moves[event.key][0], opacity + moves[event.key][1]);
    } else if (event.key === 'PageDown' || event.key === 'PageUp') {
      this.chosen = (this.chosen + (event.key === 'PageDown' ? 1 : count - 1)) % count;
      this.draw();
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      this.remove(this.chosen);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  draw() {
    const { canvas, transfer, source } = this, [width, height] = this.size();
    const dense = Math.min(window.devicePixelRatio || 1, 3);
    [canvas.width, canvas.height] = [Math.round(width * dense), Math.round(height * dense)];
    const context = canvas.getContext('2d'), style = getComputedStyle(canvas);
    context.scale(dense, dense);
    const [low, high] = domainOf(transfer, source), colorAt = walker(transfer.colors);
    const x = (value) => ((value - low) / (high - low)) * width;
    const bins = source.histogram, step = (source.upper - source.lower) / bins.length;
    context.fillStyle = style.getPropertyValue('--soft');
    context.globalAlpha = 0.4;
    bins.forEach((count, n) => {
      const tall = Math.sqrt(count / 1000) * (height - 8), from = x(source.lower + n * step);
      context.fillRect(from, height - tall, Math.max(x(source.lower + (n + 1) * step) - from, 0.5), tall);
    });
    context.globalAlpha = 1;
    for (let column = 0; column < width; ++column) {
      const [, r, g, b] = colorAt(low + ((column + 0.5) / width) * (high - low));
      context.fillStyle = `rgb(${[r, g, b].map((c) => Math.round(255 * c)).join(' ')})`;
      context.fillRect(column, height - 4, 1.5, 4);
    }
    const points = transfer.opacity.map((point) => this.place(point));
    context.strokeStyle = style.color;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(0, points[0][1]);
    for (const [px, py] of points) context.lineTo(px, py);
    context.lineTo(width, points.at(-1)[1]);
    context.stroke();
    points.forEach(([px, py], n) => {
      context.beginPath();
      context.arc(px, py, n === this.chosen ? 5 : 3.5, 0, 2 * Math.PI);
      context.fillStyle = n === this.chosen ? style.getPropertyValue('--accent') : style.color;
      context.fill();
    });
    const [value, opacity] = transfer.opacity[Math.max(this.chosen, 0)];
    canvas.setAttribute('aria-valuetext', `point ${this.chosen + 1} of ${points.length}: value ${numberText(value)}, opacity ${numberText(opacity)}`);
  }
}
