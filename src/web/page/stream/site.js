// site.js: models that are streamed from a web server (docs/streaming.md): for each view the chunks that it needs, of them what the
// quantity needs. The same calls as Levels (model/levels.js).
import { fieldPlace } from '../quantity.js';
import { isSame } from '../vectors.js';
import { extinctionIn, lightOf } from '../picture/transfer.js';
import { meets } from '../picture/clip.js';
import { leastError, mostError } from '../link/link.js';
import { drawnCut, viewOf, wantedCut } from './cut.js';
import { Loading } from './loading.js';
import { Requests } from './requests.js';
import { RangeFile } from './range_file.js';
import { Folder, cannotRead } from './source.js';
import { Store, bytesOf } from './store.js';
import { Visibility } from './visibility.js';

// Half of what a page may take, 300 MB: the rest is the browser's and the picture's.
export const mostMegabytes = 150, mostGaussians = 2e6;
const slowMs = 50, fastMs = 25, mostCoarser = 64;  // frames in motion: a larger error above, a smaller one below
const stepsAhead = 2, patienceMs = 500;            // steps in time fetched ahead; how long one that is there may stay coarse
const perHalving = 2, sliderSteps = perHalving * Math.log2(mostError / leastError);  // of the slider of detail, finest to the right
const oldMs = 200;                                 // age at which visibility is found anew while the view changes: some milliseconds
const soonMs = 15;                                 // from an arrival to the next plan

/** Where a site says that its models lie. */
export const placeOf = (site) => (site.file ? new RangeFile(site.file) : new Folder(site));

/** Promises of the bytes of files that nothing comes before. */
export function asked(source, requests, files) {
  const list = [], all = files.map((file) => new Promise((done, fail) => {
    list.push({ ...file, isFirst: true, done, failed: (_, reason) => fail(new Error(`${file.name}: ${reason}${reason.includes('Access-Control') ? '' : file.hint ?? source.hint}`)) });
  }));
  for (const one of all) one.catch(() => {});  // whoever waits for one may not wait for the others
  requests.plan(list);
  return all;
}

/** A line on a server that does not answer; isFirst: nor has before. */
export function awayLine({ host, origin }, reason, isFirst) {
  const mayBeForbidden = isFirst && origin !== self.origin, none = mayBeForbidden ? `, or none with Access-Control-Allow-Origin for ${self.origin}` : ` (${reason})`;
  return `${reason.startsWith('HTTP') ? `${host} answers ${reason}` : `No answer from ${host}${none}`}; trying again.`;
}

export class Site {
  /**
   * view  {state(), renderer(): null: none; size(): of the picture, pixels; clip(), transfer(), editing(): of what hides, changed(): draw; say(text, seconds),
   *       fail(text), refuse(): the field cannot be had; show(status of status.js)}
   * begun page.begun, {source, bytes, loaded}: the models' place, what its first() has brought, and bytes so far, where that is known
   */
  constructor(page, decoder, view) {
    Object.assign(this, { page, view, trees: null, turn: 0, planned: null, drawn: null, version: 0, coarser: 1, moving: false, ahead: [] });
    Object.assign(this, { asked: false, said: new Set(), awaited: {}, lattice: null, cut: null, reads: new Map(), soon: 0, later: 0, isStale: false });
    this.source = page.begun?.source ?? placeOf(page.site);
    this.store = new Store();
    this.requests = new Requests({ changed: () => this.requested(), away: (isAway, reason) => this.sayAway(isAway, reason) });
    this.requests.loaded = page.begun?.loaded ?? 0;
    this.loading = new Loading(page, this.source, decoder, this.store, {
      renderer: () => view.renderer(), changed: () => this.arrived(),
      lacks: (chunk, field, line) => this.lacks(chunk, field, line),
    });
  }

  get root() { return this.trees?.[this.view.state().model].root ?? null; }

  /** What the shown quantity needs of each chunk, as of bytesOf. */
  needs() {
    const state = this.view.state(), field = fieldPlace(state);
    return { field, vector: field !== null && this.page.models[state.model].fields[field].vector };
  }
  /** Limits of memory. */
  limits() {
    const { memory, most } = this.view.state();
    return { bytes: 1e6 * (memory ?? mostMegabytes), gaussians: most ?? mostGaussians };
  }
  /** Error that coarse parts may have now, pixels. */
  bound() { return this.view.state().pixelError * (this.moving ? this.coarser : 1); }
  /** Whether a chunk can be drawn. */
  isThere(chunk, field) { return Boolean(chunk.kept?.gpu) && (field === null || chunk.kept.gpu.fields.has(field)); }

  /** Reads the manifest once, then plans for the shown model. */
  async load() {
    if (this.trees || this.asked) return this.replan();
    this.asked = true;
    const line = cannotRead(this.source);
    if (line) return this.view.fail(line);
    try {
      const bytes = this.page.begun?.bytes ?? await asked(this.source, this.requests, [this.source.first()])[0];
      this.trees = await this.source.trees(bytes, this.page);
    } catch (error) {
      return this.view.fail(`The model cannot be read: ${error.message}`);
    }
    if (!this.root) this.view.say('This model is empty.', 0);
    this.replan();
  }

  // --- Plans: which files, in which order. ---

  /** All that a plan depends on but for what has come. */
  aspects() {
    const state = this.view.state(), { box, planes } = this.view.clip();
    return [state.camera, state.model, fieldPlace(state), state.show, ...this.view.size(), box, planes, state.pixelError,
      state.memory, state.most, this.moving ? this.coarser : 1, this.view.renderer(), ...this.hiding()];
  }
  /** What tells how much the shown quantity hides: none that is a sum does. */
  hiding() {
    const { show, exposure } = this.view.state();
    return show === 'T' ? [exposure] : show === 'volume' ? [this.view.transfer()] : [];
  }

  /** Something has come, or cannot be had: memory stays within its limits at once, plans follow, one for all that comes meanwhile. */
  arrived() {
    if (this.planned) this.store.tidy(this.limits(), this.turn, this.needs(), this.view.renderer());
    this.soon ||= setTimeout(() => this.replan(), soonMs);
  }

  /** inFrame: a frame is being drawn, so that none has to be asked for */
  replan(inFrame = false) {
    const renderer = this.view.renderer();
    if (!this.trees || !renderer) return;
    clearTimeout(this.soon);
    this.soon = 0;
    this.planned = this.aspects();
    ++this.turn;
    const state = this.view.state(), needs = this.needs(), room = this.limits();
    const eye = viewOf(state.camera, ...this.view.size(), this.view.clip());
    const ask = {
      error: this.bound(), room, bytesOf: (chunk) => bytesOf(chunk, needs),
      isBad: (chunk) => this.loading.isBad(chunk, needs.field),
    };
    const filesOf = (n, visible) => {
      const cut = wantedCut(this.trees[n].root, eye, this.turn, { ...ask, visible });
      room.bytes -= cut.bytes;
      room.gaussians -= cut.gaussians;
      return { model: n, cut, files: this.loading.files(this.trees[n], n, cut, needs.field) };
    };
    const visible = this.visible(eye, needs), now = filesOf(state.model, visible);
    this.cut = now.cut;
    this.ahead = [];
    for (let step = 1; this.page.steps && step <= Math.min(stepsAhead, this.trees.length - 1) && room.bytes > 0; ++step)
      this.ahead.push(filesOf((state.model + step) % this.trees.length, visible));
    // The coarsest chunk has the line for itself: it is the first picture.
    const isBegun = !this.root || this.root.wanted !== this.turn || this.isThere(this.root, needs.field) || ask.isBad(this.root);
    this.requests.plan(isBegun ? [now, ...this.ahead].flatMap(({ files }) => files) : now.files.filter(({ use }) => use === Infinity));
    this.store.tidy(this.limits(), this.turn, needs, renderer);
    if (this.settleCut(needs.field) && !inFrame) this.view.changed();
    this.report();
  }

  /** How much is seen of a chunk, by what the shown quantity hides; `isStale`: in an earlier view. */
  visible(eye, { field }) {
    const state = this.view.state(), coarse = this.root?.kept?.coarse, hiding = this.hiding(), clip = this.view.clip();
    this.isStale = false;
    if (!coarse || hiding.length === 0) return () => 1;
    const volume = state.show === 'volume', data = coarse.fields.get(field);
    // What gradients leave clear hides nothing, and a coarse model has none of the fine one's.
    if (volume && (!data || hiding[0].gradient)) return () => 1;
    const aspects = [coarse, state.show, ...hiding, data, state.camera, clip.box, clip.planes], now = performance.now();
    const isNow = this.lattice !== null && isSame(aspects, this.lattice.aspects);
    this.isStale = !isNow && this.lattice !== null && now - this.lattice.at < oldMs;
    if (this.isStale) {
      this.later ||= setTimeout(() => { this.later = 0; this.replan(); }, oldMs);
    } else if (!isNow) {
      const of = volume ? this.latticeOfValues(coarse, data, hiding[0]) :
        new Visibility(this.page.models[state.model], this.root.box, coarse.instances, () => state.exposure);
      of.look(eye, clip, volume);
      this.lattice = { aspects, of, at: now };
    }
    const { of } = this.lattice;
    return (chunk) => of.of(chunk.box);
  }
  latticeOfValues({ instances }, data, transfer) {
    const state = this.view.state(), model = this.page.models[state.model], { reference, scale: unit, isMeasure, background } = model.fields[state.field];
    return Visibility.ofValues(model, this.root.box, instances, data, extinctionIn(lightOf(transfer, { reference, unit, isMeasure, background })));
  }

  // --- Drawing. ---

  /** Finds what can be drawn; returns whether it has changed. */
  settleCut(field) {
    const before = this.drawn, wasComplete = this.complete;
    this.drawn = drawnCut(this.root, this.turn, (chunk) => this.isThere(chunk, field));
    this.complete = !this.isStale && !this.waits(this.cut, field);
    const same = before && before.root === this.root && before.parts.length === this.drawn.parts.length &&
        before.parts.every(({ chunk, first, gpu }, n) => chunk === this.drawn.parts[n].chunk && first === this.drawn.parts[n].first && gpu === chunk.kept.gpu);
    for (const part of this.drawn.parts) part.gpu = part.chunk.kept.gpu;
    this.drawn.root = this.root;
    if (!same) [this.version, this.reads] = [this.version + 1, new Map()];
    return !same || this.complete !== wasComplete;
  }

  /** Whether files of a cut are under way; not those that no server answers for, or that cannot be had. */
  waits({ chunks, tables }, field) {
    const { source, requests } = this, waitsFor = (kind, ...of) => !(requests.hasFailed && requests.isHeld(source[kind](...of).url));
    return tables.some(({ chunk }) => waitsFor('table', chunk)) || chunks.some(({ chunk }) => {
      if (this.isThere(chunk, field) || this.loading.isBad(chunk, field)) return false;
      const { kept } = chunk;
      return kept.busy.size > 0 || (kept.shapes ? kept.gpu === null : waitsFor('shapes', chunk)) ||
        (field !== null && (kept.fields.has(field) || waitsFor('field', chunk, field)));
    });
  }

  /** Parts to draw now, as Levels.now(). */
  now(moving) {
    this.moving = moving;
    // During edits the plan stays as what was hidden before has it.
    const aspects = this.aspects(), end = this.view.editing() ? aspects.length - this.hiding().length : aspects.length;
    if (!this.planned || !isSame(aspects.slice(0, end), this.planned.slice(0, end))) this.replan(true);
    const { parts, count } = this.drawn ?? { parts: [], count: 0 };
    return { parts, key: this.version, count };
  }

  /** Whether a step can be shown at once: all that its view wants, or after a while what there is. */
  isReady(model) {
    const { field } = this.needs(), root = this.trees?.[model].root;
    if (!root || !this.isThere(root, field)) return this.trees !== null && (!root || this.loading.isBad(root, field));
    const found = this.ahead.find((one) => one.model === model);
    if (found && !this.waits(found.cut, field)) return true;
    if (this.awaited.model !== model) this.awaited = { model, since: performance.now() };
    return performance.now() - this.awaited.since > patienceMs;
  }

  /** Parts that a ray may meet, as Probe takes them, read back from the GPU; null: none yet. */
  along(ray) {
    const { field } = this.needs(), renderer = this.view.renderer(), before = this.reads;
    if (!renderer || !this.drawn || this.drawn.parts.length === 0) return null;
    this.reads = new Map();
    return this.drawn.parts.filter(({ chunk, gpu }) => gpu === chunk.kept?.gpu && meets(chunk.box, ray)).map(({ gpu, first, count }) => {
      const read = before.get(gpu)?.field === field ? before.get(gpu) : { field, ...renderer.readBack(gpu, field) };
      this.reads.set(gpu, read);
      return { ...read, first, count };
    });
  }

  /** As Levels.whole(): the coarsest chunk. */
  whole() {
    const coarse = this.root?.kept?.coarse, data = coarse?.fields.get(this.needs().field);
    return data ? { instances: coarse.instances, data } : null;
  }

  frameTook(ms, moving) {
    if (moving && ms > slowMs) this.coarser = Math.min(mostCoarser, this.coarser * 1.4);
    if (moving && ms < fastMs) this.coarser = Math.max(1, this.coarser / 1.2);
  }

  /** Ends: what is under way is cancelled, and nothing stays in memory. */
  dispose() {
    clearTimeout(this.soon);
    clearTimeout(this.later);
    this.requests.dispose();
    Object.assign(this, { trees: null, planned: null, drawn: null, cut: null, lattice: null, reads: new Map(), store: new Store() });
  }

  restart() {
    this.store.restart();
    this.reads = new Map();
    this.drawn = null;
  }

  // --- Words. ---

  detail() {
    const value = sliderSteps - Math.round(perHalving * Math.log2(this.view.state().pixelError / leastError)), count = this.drawn?.count ?? 0;
    return { value, most: sliderSteps, text: `${count.toLocaleString('en')} ${count === 1 ? 'Gaussian' : 'Gaussians'}` };
  }
  detailed(value) { return { pixelError: leastError * 2 ** ((sliderSteps - Math.max(0, Math.min(sliderSteps, value))) / perHalving) }; }

  /** A request has ended: what no server answers for is not waited for. */
  requested() {
    if (this.cut && this.view.renderer() && this.settleCut(this.needs().field)) this.view.changed();
    this.report();
  }

  report() {
    const [width, height] = this.view.size();
    this.view.show({
      loaded: this.requests.loaded, toCome: this.requests.toCome.length, isFull: this.cut !== null && this.cut.error > this.bound(),
      error: Math.min(this.drawn?.error ?? Infinity, Math.max(width, height)),
    });
  }

  /** Says why something cannot be had, the first time. */
  lacks(chunk, field, line) {
    const isRoot = !chunk.parent && (chunk.bad || field !== null), kind = isRoot ? 'root' : 'part';
    if (isRoot && field !== null && chunk === this.root) return this.view.refuse(line);
    if (isRoot && this.trees.length === 1) return this.view.fail(`The model cannot be read: ${line}`);
    if (!this.said.has(kind)) this.view.say(`${line}: ${isRoot ? 'one of the models cannot be shown' : 'the picture stays coarse there'}.`, 12);
    this.said.add(kind);
  }

  sayAway(isAway, reason) {
    if (!isAway) this.view.say('');
    else this.view.say(awayLine(this.source.base, reason, !this.trees), 0);
  }
}
