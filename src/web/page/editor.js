// editor.js: editor of a transfer function of values: histogram of the field, curve of opacity with points, lines and
// bands to drag, on a linear or logarithmic axis, undo and redo.
import { walker } from './picture/colors.js';
import { numberText } from './quantity.js';

const reach = 9, lineReach = 5;  // CSS pixels within which a point or a line is grabbed
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

/**
 * Axis of values: the field's range and the points', {low, high, log}, with share(value) and value(share) from 0 to 1.
 * log  whether it is logarithmic, which takes a range above 0
 */
function axisOf(transfer, source, log) {
  const values = [...transfer.colors, ...transfer.opacity].map(([v]) => v).filter((v) => !log || v > 0);
  const low = Math.min(source.lower, ...values), most = Math.max(source.upper, ...values);
  const high = most > low ? most : log ? 2 * low : low + 1;
  if (!log) return { low, high, log, share: (v) => (v - low) / (high - low), value: (s) => low + s * (high - low) };
  const decades = Math.log(high / low);
  return { low, high, log, share: (v) => Math.log(Math.max(v, 1e-300) / low) / decades, value: (s) => low * Math.exp(s * decades) };
}

/** Opacity curves to start from; v(share): value on the axis. */
export const presets = {
  Ramp: (v) => [[v(0), 0], [v(1), 1]],
  'Upper half': (v) => [[v(0), 0], [v(0.5), 0], [v(1), 1]],
  Bands: (v) => [0.15, 0.4, 0.65].flatMap((at) => [[v(at - 0.03), 0], [v(at), 0.8], [v(at + 0.03), 0]]),
  Surface: (v) => [[v(0), 0], [v(0.29), 0], [v(0.3), 0.99], [v(1), 0.99]],
};

/** Distance of a point from the line between two others. */
function distanceFrom([x, y], [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay], along = clamp(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0, 1);
  return Math.hypot(ax + along * dx - x, ay + along * dy - y);
}

export class Editor {
  /**
   * change   called with an edited transfer function
   * restore  called with what undo() brings back: {transfer, light}
   */
  constructor(canvas, change, restore) {
    Object.assign(this, { canvas, change, restore });
    [this.first, this.last] = [0, 0];  // chosen points of opacity
    this.grip = null;   // what the pointer holds: {share, opacity, points, axis, vertical, moved}
    this.past = [];
    this.future = [];
    this.transfer = null;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', () => this.up());
    canvas.addEventListener('pointercancel', () => { this.grip = null; });
    canvas.addEventListener('dblclick', (event) => this.remove(this.near(event)));
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  /** What undo() brings back. */
  get now() { return { transfer: this.transfer, light: this.light }; }

  /** Shows a transfer function over a field's histogram; light: of the picture; log: on a logarithmic axis where the field is above 0. */
  show(transfer, source, light, log = false) {
    this.light = light;
    if (this.source && this.source !== source) [this.past, this.future] = [[], []];
    [this.transfer, this.source, this.axis] = [transfer, source, axisOf(transfer, source, log && source.lower > 0)];
    [this.first, this.last] = [this.first, this.last].map((n) => clamp(n, 0, transfer.opacity.length - 1));
    this.draw();
  }

  /** Changes the transfer function; `one` edits in a row are undone at once. */
  edit(transfer, one = false) {
    if (!one) this.remember();
    this.future = [];
    this.change(transfer);
  }
  remember() {
    this.past.push(this.now);
    this.future = [];
    if (this.past.length > 100) this.past.shift();
  }
  undo() {
    if (this.past.length === 0) return;
    this.future.push(this.now);
    this.restore(this.past.pop());
  }
  redo() {
    if (this.future.length === 0) return;
    this.past.push(this.now);
    this.restore(this.future.pop());
  }

  size() { return [this.canvas.clientWidth || 220, this.canvas.clientHeight || 96]; }
  place([value, opacity], axis = this.axis) {
    const [width, height] = this.size();
    return [axis.share(value) * width, (1 - opacity) * (height - 8) + 4];
  }
  /** Place of a pointer: [x, y] in CSS pixels. */
  pixel(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }
  /** Share of the axis and opacity under the pointer. */
  at(event) {
    const [x, y] = this.pixel(event), [width, height] = this.size();
    return [clamp(x / width, 0, 1), clamp(1 - (y - 4) / (height - 8), 0, 1)];
  }
  /** Point under the pointer; -1: none. */
  near(event) {
    const [x, y] = this.pixel(event);
    const distances = this.transfer.opacity.map((point) => {
      const [px, py] = this.place(point);
      return Math.hypot(px - x, py - y);
    });
    const least = Math.min(...distances);
    return least <= reach ? distances.indexOf(least) : -1;
  }
  /**
   * Points that a press beside them takes along: the two ends of the line under the pointer; below the curve those of
   * the band, between its feet, which then keeps its opacities; null: none.
   */
  bandAt(event) {
    const { opacity } = this.transfer, pixel = this.pixel(event), [share, height] = this.at(event);
    const places = opacity.map((point) => this.place(point));
    const left = places.findLastIndex(([x]) => x <= pixel[0]);
    if (left < 0 || left + 1 >= places.length) return null;
    const [, curve] = walker(opacity)(this.axis.value(share));
    if (distanceFrom(pixel, places[left], places[left + 1]) <= lineReach) return { first: left, last: left + 1, vertical: true };
    if (height >= curve) return null;
    let [first, last] = [left, left + 1];
    while (first > 0 && opacity[first][1] > 1e-3) --first;
    while (last + 1 < opacity.length && opacity[last][1] > 1e-3) ++last;
    // A curve from end to end has no way to go.
    const stuck = this.axis.share(opacity[first][0]) <= 1e-6 && this.axis.share(opacity[last][0]) >= 1 - 1e-6;
    return stuck ? null : { first, last, vertical: false };
  }

  insert([share, opacity]) {
    const point = [this.axis.value(share), opacity], points = this.transfer.opacity;
    const place = points.filter(([v]) => v <= point[0]).length;
    [this.first, this.last] = [place, place];
    this.edit({ ...this.transfer, opacity: [...points.slice(0, place), point, ...points.slice(place)] }, true);
  }
  down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const hit = this.near(event), band = hit < 0 ? this.bandAt(event) : null, at = this.at(event);
    let vertical = true, moved = false;
    if (hit >= 0 && event.shiftKey) {
      [this.first, this.last] = [Math.min(hit, this.first), Math.max(hit, this.last)];
    } else if (hit >= 0) {
      if (hit < this.first || hit > this.last) [this.first, this.last] = [hit, hit];
    } else if (band) {
      ({ first: this.first, last: this.last, vertical } = band);
    } else {
      this.remember();
      this.insert(at);
      moved = true;
    }
    this.grip = { at, points: this.transfer.opacity, axis: this.axis, vertical, moved, fresh: band !== null, hit: event.shiftKey ? -1 : hit };
    this.draw();
  }
  move(event) {
    const { grip } = this;
    if (!grip) return;
    const [share, opacity] = this.at(event), by = [share - grip.at[0], grip.vertical ? opacity - grip.at[1] : 0];
    if (!grip.moved && by[0] === 0 && by[1] === 0) return;
    if (!grip.moved) this.remember();
    grip.moved = true;
    this.shift(grip.points, grip.axis, ...by);
  }
  /** A press that did not move chooses its point, or is a new one. */
  up() {
    const { grip } = this;
    this.grip = null;
    if (!grip || grip.moved) return;
    if (grip.hit >= 0) {
      this.first = this.last = grip.hit;
      this.draw();
    }
    if (!grip.fresh) return;
    this.remember();
    this.insert(grip.at);
  }
  /** Moves the chosen points as one, between their neighbours. */
  shift(points, axis, aside, upwards) {
    const { first, last } = this, shares = points.map(([v]) => axis.share(v));
    const least = Math.max(shares[first - 1] ?? 0, 0), most = Math.min(shares[last + 1] ?? 1, 1);
    const chosen = points.slice(first, last + 1).map(([, opacity]) => opacity);
    const by = clamp(aside, Math.min(least - shares[first], 0), Math.max(most - shares[last], 0));
    const up = clamp(upwards, -Math.min(...chosen), 1 - Math.max(...chosen));
    const opacity = points.map(([v, o], n) => (n < first || n > last ? [v, o]
      : [by === 0 ? v : axis.value(shares[n] + by), clamp(o + up, 0, 1)]));
    this.edit({ ...this.transfer, opacity }, true);
  }
  /** Removes points, but the last one. */
  remove(from, to = from) {
    const { opacity } = this.transfer;
    if (from < 0 || opacity.length < 2 + to - from) return;
    this.edit({ ...this.transfer, opacity: opacity.filter((_, k) => k < from || k > to) });
  }
  key(event) {
    const step = event.shiftKey ? 0.05 : 0.01, { opacity } = this.transfer, end = opacity.length - 1;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, 0.02], ArrowDown: [0, -0.02] };
    if (moves[event.key]) {
      this.remember();
      this.shift(opacity, this.axis, ...moves[event.key]);
    } else if (event.key === 'PageDown' || event.key === 'PageUp') {
      const on = event.key === 'PageDown';
      if (event.shiftKey) this[on ? 'last' : 'first'] = on ? Math.min(this.last + 1, end) : Math.max(this.first - 1, 0);
      else this.first = this.last = on ? (this.last + 1) % (end + 1) : (this.first + end) % (end + 1);
      this.draw();
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      this.remove(this.first, this.last);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  draw() {
    const { canvas, transfer, source, axis } = this, [width, height] = this.size();
    const dense = Math.min(window.devicePixelRatio || 1, 3);
    [canvas.width, canvas.height] = [Math.round(width * dense), Math.round(height * dense)];
    const context = canvas.getContext('2d'), style = getComputedStyle(canvas);
    context.scale(dense, dense);
    const colorAt = walker(transfer.colors), opacityAt = walker(transfer.opacity);
    const bins = axis.log ? source.logHistogram : source.histogram;
    const ends = axisOf({ colors: [], opacity: [] }, source, axis.log);
    const x = (share) => axis.share(ends.value(share)) * width;
    context.fillStyle = style.getPropertyValue('--soft');
    context.globalAlpha = 0.4;
    bins.forEach((count, n) => {
      const tall = Math.sqrt(count / 1000) * (height - 8), from = x(n / bins.length);
      context.fillRect(from, height - tall, Math.max(x((n + 1) / bins.length) - from, 0.5), tall);
    });
    context.globalAlpha = 1;
    const curve = [];
    for (let column = 0; column < width; ++column) {
      const value = axis.value((column + 0.5) / width), [, r, g, b] = colorAt(value);
      context.fillStyle = `rgb(${[r, g, b].map((c) => Math.round(255 * c)).join(' ')})`;
      context.fillRect(column, height - 4, 1.5, 4);
      curve.push([column + 0.5, this.place([value, opacityAt(value)[1]])[1]]);
    }
    const points = transfer.opacity.map((point) => this.place(point));
    context.strokeStyle = style.color;
    context.lineWidth = 1.5;
    context.beginPath();
    // Straight between points, but on a logarithmic axis.
    const through = axis.log ? [...curve, ...points].sort((a, b) => a[0] - b[0]) : points;
    context.moveTo(0, through[0][1]);
    for (const [px, py] of through) context.lineTo(px, py);
    context.lineTo(width, through.at(-1)[1]);
    context.stroke();
    points.forEach(([px, py], n) => {
      context.beginPath();
      const chosen = n >= this.first && n <= this.last;
      context.arc(px, py, chosen ? 5 : 3.5, 0, 2 * Math.PI);
      context.fillStyle = chosen ? style.getPropertyValue('--accent') : style.color;
      context.fill();
    });
    const [value, opacity] = transfer.opacity[this.first], [to] = transfer.opacity[this.last];
    const [low, high] = [transfer.opacity[0][0], transfer.opacity.at(-1)[0]], text = (v) => numberText(v, 0.01 * (high - low));
    const which = this.first === this.last ? `point ${this.first + 1} of ${points.length}: value ${text(value)}`
      : `points ${this.first + 1} to ${this.last + 1} of ${points.length}: values ${text(value)} to ${text(to)}`;
    canvas.setAttribute('aria-valuetext', `${which}, opacity ${numberText(opacity)}`);
  }
}
