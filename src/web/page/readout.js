// readout.js: the numbers under the pointer.
import { inSlabs, label, numberText, stepOf } from './quantity.js';

/** Lines on the sums of one pixel. text: of the shown quantity's numbers */
function linesOfSums(sums, model, state, text) {
  if (!sums || !(sums[0] > 0)) return [];
  if (inSlabs(state.show)) {
    const { reference, scale } = model.fields[state.field];
    return [`${label(model, state)} ${text(reference + (scale * sums[1]) / sums[0])}`];
  }
  const lines = [state.show === 'T' ? `T ${numberText(sums[0] * state.exposure)}` : `column ${(state.show === 'column' ? text : numberText)(sums[0] / model.extinction)}`];
  if (state.show !== 'mean' && state.show !== 'deviation') return lines;
  const { reference, scale } = model.fields[state.field];
  if (state.part === 'magnitude')
    return [...lines, `${label(model, state)} ${text(scale * Math.sqrt(Math.max(sums[2] / sums[0], 0)))}`];
  const mean = sums[1] / sums[0], deviation = Math.sqrt(Math.max(sums[2] / sums[0] - mean * mean, 0));
  return [...lines, `mean ${label(model, { ...state, show: 'mean' })} ${text(reference + scale * mean)}`,
    `deviation ${text(scale * deviation)}`];
}

/** Lines on one ray of a volume: Probe's answer. */
function linesOfRay({ opacity, value, depth }, model, state, text) {
  if (!(opacity > 1e-3)) return [];
  const lines = [`opacity ${numberText(Number(opacity.toFixed(3)))}`];
  return value === null ? lines : [`${label(model, state)} ${text(value)}`, `depth ${numberText(depth)}`, ...lines];
}

export class Readout {
  /**
   * canvas  of the picture
   * view    the Viewer
   * tell    called with the lines, of which there may be none
   */
  constructor(canvas, view, tell) {
    Object.assign(this, { view, tell, pixel: null });
    const { signal } = view.ended;
    canvas.addEventListener('pointermove', (event) => {
      const box = canvas.getBoundingClientRect(), scale = canvas.width / box.width;
      this.pixel = [Math.floor((event.clientX - box.left) * scale), Math.floor((event.clientY - box.top) * scale)];
      if (!view.moving && !view.inFlight) this.show();  // else once that picture has been drawn
    }, { signal });
    canvas.addEventListener('pointerleave', () => {
      this.pixel = null;
      this.show();
    }, { signal });
  }

  lines() {
    const { model, state, transfer, scale } = this.view, step = transfer ? 0.01 * (transfer.colors.at(-1)[0] - transfer.colors[0][0]) : stepOf(scale);
    const text = (value) => numberText(value, step);
    if (!this.pixel) return [];
    if (!transfer) return linesOfSums(this.view.sums(this.pixel), model, state, text);
    const found = this.view.probed(this.pixel);
    return found ? linesOfRay(found, model, state, text) : [];
  }

  show() { this.tell(this.lines()); }
  /** Shows the numbers of another picture under a pointer at rest. */
  renew() { if (this.pixel) this.show(); }
}
