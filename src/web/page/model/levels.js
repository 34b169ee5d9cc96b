// levels.js: models of a one-file page: levels of detail in its script elements, decoded when first shown, coarsest first.
// The same calls as Site (stream/site.js), of which a Viewer has one or the other.
import { fieldPlace } from '../quantity.js';
import { instanceFloats } from './gaussians.js';

const mostKept = 1 << 26;  // floats of decoded steps in memory
const stepsAhead = 3;
const slowMs = 50;         // slower frames: coarser levels while the camera moves
const fastMs = 12;         // faster frames: finer levels again

export class Levels {
  /** view  {state(); renderer(): null: none; changed(): draw; say(text, seconds)} */
  constructor(page, decoder, view) {
    Object.assign(this, { page, decoder, view, scene: [], turn: 0, complete: false, coarser: 0 });
  }

  last(model) { return this.page.models[model].levels.length - 1; }
  /** Of each level {instances, fields: Map of places, gpu}, or null: not decoded. */
  levelsOf(model) { return (this.scene[model] ??= this.page.models[model].levels.map(() => null)); }
  /** Whether a level has all that the shown quantity needs. */
  hasLevel(model, level) {
    const entry = this.levelsOf(model)[level], field = fieldPlace(this.view.state());
    return entry !== null && (field === null || entry.fields.has(field));
  }
  /** Whether a step can be shown at once. */
  isReady(model) { return this.hasLevel(model, Math.min(this.view.state().level, this.last(model))); }

  /** Level to draw: the chosen one, a coarser one while moving, or the next coarser one decoded; -1: none. */
  level(moving) {
    const { model, level } = this.view.state(), last = this.last(model);
    let n = Math.min(level + (moving ? this.coarser : 0), last);
    while (n < last && !this.hasLevel(model, n)) ++n;
    return this.hasLevel(model, n) ? n : -1;
  }

  /** Parts to draw now, {parts: of renderer.js, key: another where they are others, count: Gaussians}. */
  now(moving) {
    const state = this.view.state(), level = this.level(moving);
    if (level < 0) return { parts: [], key: -1, count: 0 };
    const entry = this.levelsOf(state.model)[level], field = fieldPlace(state), renderer = this.view.renderer();
    entry.gpu ??= renderer.upload(entry.instances, this.page.models[state.model].cutoff);
    if (field !== null && !entry.gpu.fields.has(field))
      renderer.uploadField(entry.gpu, field, entry.fields.get(field), this.page.models[state.model].fields[field].vector);
    const { gpu } = entry, parts = gpu.count > 0 ? [{ gpu, first: 0, count: gpu.count }] : [];
    return { parts, key: level, count: this.page.models[state.model].levels[level].count };
  }

  /** Parts that a ray may meet, as Probe takes them; null: none yet. */
  along() {
    const { model, field } = this.view.state(), level = this.level(false);
    if (level < 0) return null;
    const { instances, fields } = this.levelsOf(model)[level];
    return [{ instances, data: fields.get(field), first: 0, count: instances.length / instanceFloats }];
  }

  /** Gaussians of the whole model, {instances, data: of the shown field}, for its shadows; null: none yet. */
  whole() { return this.along()?.[0] ?? null; }

  /** Detail for the slider: {value, most, text}; and the change of the state for a value. */
  detail() {
    const { model, level } = this.view.state(), { count } = this.page.models[model].levels[level];
    return { value: this.last(model) - level, most: this.last(model), text: `${count.toLocaleString('en')} ${count === 1 ? 'Gaussian' : 'Gaussians'}` };
  }
  detailed(value) {
    const last = this.last(this.view.state().model);
    return { level: Math.max(0, Math.min(last - value, last)) };
  }

  /** Fewer Gaussians after slow frames while the camera moves, more after fast ones. */
  frameTook(ms, moving) {
    const { model, level } = this.view.state();
    if (moving && ms > slowMs) ++this.coarser;
    if (moving && ms < fastMs) this.coarser = Math.max(0, this.coarser - 1);
    this.coarser = Math.min(this.coarser, this.last(model) - level);
  }

  /** The GPU has lost all. */
  restart() {
    for (const levels of this.scene) for (const entry of levels ?? []) if (entry) entry.gpu = undefined;
  }

  /** Decodes one level and the shown field, unless it has been. */
  async decode(model, level) {
    const levels = this.levelsOf(model), { extinction, center, unit, fields } = this.page.models[model], field = fieldPlace(this.view.state());
    const text = this.page.textOf(model, level);
    if (!levels[level]) {
      const instances = await this.decoder.decoded('decodeLevel', text, { center, unit }, extinction);
      levels[level] ??= { instances, fields: new Map(), gpu: undefined };
    }
    if (field === null || !fields[field] || levels[level].fields.has(field)) return;
    const { vector, reference, scale } = fields[field];
    levels[level].fields.set(field, await this.decoder.decoded('decodeField', text, field, { vector, reference, scale }));
  }

  /** Frees the GPU's memory of models that are not shown, and of steps in memory the farthest ahead. */
  tidy() {
    let kept = 0;
    for (let ahead = 0; ahead < this.page.models.length; ++ahead) {
      const model = (this.view.state().model + ahead) % this.page.models.length;
      for (const entry of this.scene[model] ?? []) {
        if (!entry) continue;
        if (entry.gpu && ahead > 1) {
          this.view.renderer()?.release(entry.gpu);
          entry.gpu = undefined;
        }
        kept += entry.instances.length;
        for (const data of entry.fields.values()) kept += data.length;
      }
      if (kept > mostKept && ahead > 1) this.scene[model] = undefined;
    }
  }

  /** Decodes the shown model's levels, coarsest first, and draws each when decoded; then the steps that follow. */
  async load() {
    const turn = ++this.turn, { model } = this.view.state(), { levels } = this.page.models[model];
    this.tidy();
    this.complete = levels.every((_, level) => this.hasLevel(model, level));
    for (let level = levels.length - 1; level >= 0 && !this.complete; --level) {
      await this.decode(model, level);
      if (turn !== this.turn) return;
      this.view.changed();
    }
    this.complete = true;
    if (levels[0].count === 0) this.view.say('This model is empty.', 0);
    this.view.changed();
    for (let ahead = 1; this.page.steps && ahead <= Math.min(stepsAhead, this.page.models.length - 1); ++ahead) {
      const next = (model + ahead) % this.page.models.length;
      await this.decode(next, Math.min(this.view.state().level, this.last(next)));
      if (turn !== this.turn) return;
    }
  }
}
