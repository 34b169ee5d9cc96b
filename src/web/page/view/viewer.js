// viewer.js: a view of models on a canvas: its state, its frames, its changes, its picture. Whatever surrounds the canvas, a page's controls or a
// foreign page, is told; nothing outside of the canvas is touched.
import { isSame } from '../vectors.js';
import { carriedOver, filling } from '../camera.js';
import { fading, reversed } from '../picture/colors.js';
import { overRange } from '../picture/transfer.js';
import { Renderer } from '../picture/renderer.js';
import { Slabs } from '../picture/slabs.js';
import { Probe, rayOf } from '../picture/probe.js';
import { automaticScale, automaticTransfer, comparable, fieldPlace, inSlabs, quantityNumber, sumsOf } from '../quantity.js';
import { changedState, firstState, partOfLink, writeLink } from '../link/link.js';
import { attachPointers } from '../input.js';
import { attachContext, freeContext } from './context.js';

const restMs = 200;       // time without motion or edits after which the picture counts as at rest
const slowMs = 50;        // frames that take longer have fewer pixels during edits, where not all their sums have room
const halfMs = 6;         // pictures have half the resolution in motion until frames take less: whole ones take up to eight times as long, about slowMs
const manyPixels = 1 << 19;  // from which frames of T and maps take the time of their pixels rather than of their Gaussians
const patienceMs = 100;   // no further sub-frames after one that took longer

const rangeOf = ({ reference, scale, isMeasure, background }) => ({ reference, unit: scale, isMeasure, background });

export class Viewer {
  /**
   * given  {page: the description of its models and first picture, shaders: texts by file name, decoder of decoder.js, Models: the class of levels.js or site.js,
   *        panel: whether controls are shown}
   * tell   {shown(): the state has changed; resized(); drawn(count): a picture at rest; took(ms): a frame; say(text, seconds): a notice, 0 until the
   *        next; fail(text): no picture; status(of site.js); ground(color): of the background; playing(): whether steps in time run;
   *        reopen(): the view, from its beginning, as its context does not come back}
   */
  constructor(canvas, { page, shaders, decoder, Models, panel }, tell) {
    Object.assign(this, { canvas, page, shaders, decoder, tell, state: firstState(page, panel), renderer: null, slabs: null, half: false, lost: false });
    Object.assign(this, { automatic: null, drawn: null, count: 0, loads: 0, moving: 0, editing: 0, edited: false, coarse: false, inMotion: false, isHalved: false });
    Object.assign(this, { frame: 0, inFlight: false, frameMs: 0, stale: false, waiting: [], ended: new AbortController(), probe: new Probe() });
    this.authored = this.state.camera;
    this.ground = { background: page.background, systemBackground: page.systemBackground };
    this.system = matchMedia('(prefers-color-scheme: light)');
    this.source = new Models(page, decoder, {
      state: () => this.state, renderer: () => (this.lost ? null : this.renderer), size: () => [canvas.width, canvas.height],
      clip: () => this.clip, transfer: () => this.transfer, editing: () => this.editing, changed: () => this.redraw(),
      say: tell.say, fail: (text) => tell.fail(`${text}.`), show: tell.status,
      refuse: (line) => this.refuse('shown', line),
    });
    this.size = new ResizeObserver(() => this.fit());
  }

  /** Begins: the first frame, and the loading of what it shows. */
  start() {
    const { signal } = this.ended;
    attachPointers(this.canvas, this, signal);
    attachContext(this, signal);
    this.restart();
    if (signal.aborted) return;
    this.system.addEventListener('change', () => this.followSystem(), { signal });
    this.followSystem();
    this.size.observe(this.canvas);
    this.fit();
    this.load();
  }

  /** Ends: frees the GPU's memory, the worker, and what is under way. */
  dispose() {
    freeContext(this);
    this.lost = true;
    this.ended.abort();
    this.size.disconnect();
    cancelAnimationFrame(this.frame);
    for (const timer of [this.moving, this.editing]) clearTimeout(timer);
    this.source.dispose?.();
    this.decoder.dispose();
    this.renderer?.gl.getExtension('WEBGL_lose_context')?.loseContext();
    this.renderer = this.slabs = null;
    for (const { reject } of this.waiting.splice(0)) reject(new Error('the view has been removed'));
  }

  // --- What is shown. ---

  get models() { return comparable(this.page, this.state.model); }
  get model() { return this.page.models[this.state.model]; }
  get box() { return this.model.box; }
  get map() {
    const map = this.page.maps.find(({ name }) => name === this.state.map);
    return this.state.reverse ? reversed(map) : map;
  }
  get clip() { return { box: this.state.clip, planes: this.state.planes }; }
  get scale() {
    const { scale } = this.state;
    return scale?.low === undefined ? automaticScale(this.models, this.state, scale?.log) : scale;
  }
  /** The transfer function of the shown field; null: the quantity has none. */
  get transfer() {
    const { page, state } = this;
    if (state.show !== 'volume') return null;
    if (state.transfers[state.field]) return state.transfers[state.field];
    const key = [page.steps ? 0 : state.model, state.field, state.map, state.reverse].join(' ');
    // Without edits.
    if (this.automatic?.[0] !== key) this.automatic = [key, automaticTransfer(this.models, state.field, this.map)];
    return this.automatic[1];
  }
  get busy() { return Boolean(this.moving || this.tell.playing()); }
  get ready() { return Boolean(this.renderer && !this.lost); }

  // --- Drawing. What sumsOf lists draws the model anew; all else only finishes the sums. ---

  request() {
    if (!this.frame && !this.inFlight && this.ready) this.frame = requestAnimationFrame(() => this.draw());
  }

  /** Whether the frame is one of a motion for which whole ones take too long. */
  get isBrief() { return this.inMotion && this.isHalved; }
  get slabCount() {
    const { show, light } = this.state;
    const count = this.page.slabs[show !== 'volume' ? 1 : light.on || light.shadows || light.occlusion || this.transfer?.gradient ? 2 : 0];
    return this.isBrief ? Math.ceil(count / 2) : count;
  }
  /** What pictures are finished with after their slabs are drawn. */
  get finish() { return this.state.show === 'volume' ? [this.transfer, this.state.light, this.isDraft] : []; }
  /** Whether ambient occlusion uses larger cells. */
  get isDraft() { return this.state.light.occlusion && Boolean(this.editing || !this.source.complete); }
  /** Which sums there are, and what may be edited after them: the exposure of streamed models decides what is hidden. */
  get edits() {
    const { show, field, model, exposure } = this.state;
    return [[show, field, model].join(' '), this.page.site && show === 'T' && exposure, ...this.finish];
  }

  /** Adds one sub-frame of the shown quantity. */
  addSums(parts, of) {
    const { renderer, state, model, clip } = this, field = fieldPlace(state), { camera } = state;
    if (inSlabs(state.show)) {
      this.slabs ??= new Slabs(renderer);
      this.slabs.add(parts, model, camera, {
        field, transfer: this.transfer, light: state.light, clip, slabs: this.slabCount, of, keep: !this.inMotion && (state.panel || this.edited),
        source: rangeOf(model.fields[field]), whole: state.show === 'volume' ? this.source.whole() : null, draft: this.isDraft,
      });
    } else {
      renderer.addSums(parts, model, camera, { field, part: field === null ? '' : state.part, clip });
    }
  }

  draw() {
    this.frame = 0;
    if (!this.ready) return;
    try {
      this.drawNow();
    } catch (error) {
      if (this.lost || this.renderer.gl.isContextLost()) return;
      if (this.state.show === 'T') return this.tell.fail(`No picture here: ${error.message}.`);
      this.refuse('drawn here', error.message);
    }
  }

  /** Back to T, which needs no field and the least of a device. */
  refuse(what, reason) {
    this.change({ show: 'T' });
    this.tell.say(`This quantity cannot be ${what}: ${reason}.`, 12);
  }

  drawNow() {
    const { state, renderer, canvas } = this, there = this.source.now(this.busy);
    this.inMotion = Boolean(this.moving);
    const kept = this.coarse && state.show === 'volume' && this.slabs?.shareKept({ light: state.light, transfer: this.transfer, slabs: this.slabCount }, canvas.width * canvas.height);
    const isHalf = this.isBrief && (inSlabs(state.show) || canvas.width * canvas.height >= manyPixels), share = Math.sqrt(kept || 1) * (isHalf ? 0.5 : 1);
    const size = [canvas.width, canvas.height].map((n) => Math.max(1, Math.floor(share * n))), now = sumsOf(state, there.key, size, this.slabCount);
    this.count = there.count;
    renderer.choose(now.of, this.finish);
    renderer.resize(...size);
    if (!this.drawn || !isSame(now.view, this.drawn.view)) {
      renderer.restart();
      this.slabs?.restart(state.show === 'volume');
    }
    this.drawn = now;
    if (renderer.subframes === 0 || this.wantsMore) this.addSums(there.parts, now.of);
    this.shade();
    if (this.inFlight) this.stale = true;
    else this.time();
  }

  shade() {
    const { state, model, page } = this, source = model.fields[state.field];
    this.renderer.shade({
      quantity: quantityNumber(state), scale: this.scale, fade: state.fade, background: page.background,
      factor: state.show === 'T' ? state.exposure : state.show === 'volume' ? 1 : 1 / model.extinction,
      unit: source ? [source.reference, source.scale] : [0, 1], leastColumn: inSlabs(state.show) ? 0 : page.leastColumn * model.mostColumn,
    });
  }

  /** Whether to add a sub-frame. The first frame's time is ignored: it may include shader compilation. */
  get wantsMore() {
    const { subframes } = this.renderer;
    return !this.busy && !this.editing && subframes < this.state.subframes && (subframes < 2 || this.frameMs < patienceMs);
  }

  /** Waits until the GPU has finished the frame, measures its time, then allows the next. */
  time() {
    const { gl } = this.renderer, start = performance.now();
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.inFlight = true;
    const poll = () => {
      if (!this.lost && fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED)
        return setTimeout(poll, 2);
      gl.deleteSync(fence);
      this.inFlight = false;
      if (!this.renderer) return;
      this.frameMs = performance.now() - start;
      if (this.inMotion) this.isHalved = this.frameMs > (this.isHalved ? halfMs : slowMs);
      this.tell.took(this.frameMs);
      this.source.frameTook(this.frameMs, this.page.site ? this.busy : Boolean(this.moving));
      this.afterFrame();
    };
    setTimeout(poll, 0);
  }

  afterFrame() {
    if (this.stale || this.wantsMore) {
      this.stale = false;
      return this.request();
    }
    if (this.moving || this.editing || !this.source.complete) return;
    this.tell.drawn(this.count);
    for (const { resolve } of this.waiting.splice(0)) resolve();
  }

  redraw() {
    this.stale = this.inFlight;
    this.request();
  }

  /** A renderer of the canvas's context, a new one or one that has come back. */
  restart() {
    try {
      this.renderer = new Renderer(this.canvas, this.shaders, this.half);
    } catch (error) {
      this.renderer = null;
      this.tell.fail(`No picture here: ${error.message}. Try a recent version of Firefox, Chrome or Safari.`);
      return;
    }
    this.slabs = null;
    this.source.restart();
    this.drawn = null;
    this.setMap();
    if (this.renderer.format.bits === 16)
      this.tell.say('32-bit float blending is missing on this device: sums are kept in 16-bit floats, and ' +
          'faint parts may show steps.', 12);
  }

  setMap() {
    this.renderer?.setMap(this.state.show === 'T' && this.state.fade ? fading(this.map) : this.map);
  }

  /** Has all that the state shows decoded, coarse first. */
  load() {
    if (this.loads++ > 0 && !this.page.steps && !this.lost) this.tell.say('');
    this.source.load().catch((error) => this.tell.fail(`The page cannot be read: ${error.message}.`));
  }

  /** Sets the canvas to the screen's resolution, at most two pixels per CSS pixel. */
  fit() {
    const { canvas } = this;
    this.tell.resized();
    const scale = Math.min(globalThis.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (width === canvas.width && height === canvas.height) return;
    // Setting the size clears the canvas, so it is drawn again at once.
    canvas.width = width;
    canvas.height = height;
    if (!this.ready || !this.drawn) return this.redraw();
    cancelAnimationFrame(this.frame);
    this.draw();
  }

  // --- Changes. ---

  /** Changes part of the state; the only place that does. */
  change(part) {
    const { state, page } = this, before = { ...state }, edits = this.edits;
    Object.assign(state, changedState(page, before, part));
    const differs = (...keys) => keys.some((key) => state[key] !== before[key]);
    if (differs('map', 'reverse', 'fade', 'show')) this.setMap();
    if (differs('map', 'reverse') && !part.transfers) this.recolor();
    if (this.renderer && differs('model', 'field', 'show')) this.load();
    if (this.drawn && this.edits[0] === edits[0] && !isSame(this.edits, edits)) this.edit();
    this.tell.shown();
    this.redraw();
  }

  /** Finishes the sums that are there, until the edits rest. */
  edit() {
    this.coarse ||= this.frameMs > slowMs;
    this.edited = true;
    clearTimeout(this.editing);
    this.editing = setTimeout(() => {
      this.editing = 0;
      this.coarse = false;
      this.redraw();
    }, restMs);
  }

  /** Another map in an edited transfer function: its colours over the same values. */
  recolor() {
    const { state } = this, edited = state.transfers[state.field];
    if (!edited) return;
    const [from, to] = [edited.colors[0][0], edited.colors.at(-1)[0]], source = this.model.fields[state.field];
    const [low, high] = to > from ? [from, to] : [source.lower, source.upper];
    const log = source.log && low === source.values[0] && high === source.values[1];
    const { colors } = overRange(this.map, low, high, 1, log);
    state.transfers = { ...state.transfers, [state.field]: { ...edited, name: state.map, colors } };
  }

  move(camera) {
    clearTimeout(this.moving);
    this.moving = setTimeout(() => {
      this.moving = 0;
      this.redraw();
    }, restMs);
    this.change({ camera });
  }

  /** Initial view: the author's, or the default enlarged to fill a tall screen. */
  get firstView() {
    const { clientWidth, clientHeight } = this.canvas, { page, authored } = this;
    return page.chosenView ? authored : filling(authored, page.models[0].box, clientWidth, clientHeight);
  }
  get home() { return this.page.steps ? this.firstView : carriedOver(this.firstView, this.page.models[0].box, this.box); }

  /** Applies settings of readLink; others stay. Returns a line for each that cannot be. */
  apply(settings) {
    const { part, background, problems } = partOfLink(this.page, this.state, settings, this.firstView);
    this.half = settings.settings.half ?? this.half;
    if (background) this.setBackground(background);
    this.change(part);
    return problems;
  }

  /** Sets a background of partOfRequest; 'system' is black or white, as the system is dark or light. */
  setBackground(background) {
    const { page } = this;
    Object.assign(page, background === 'first' ? this.ground : { background, systemBackground: background === 'system' });
    if (page.systemBackground) page.background = this.system.matches ? [1, 1, 1, 1] : [0, 0, 0, 1];
    this.showGround();
  }
  followSystem() {
    if (!this.page.systemBackground) return;
    this.setBackground('system');
    this.change({});
  }
  /** Tells what texts lie on: 'light', 'dark', or 'clear' for a transparent background. */
  showGround() {
    const [r, g, b, a] = this.page.background, luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    this.tell.ground(a < 0.5 ? 'clear' : luma > 0.5 ? 'light' : 'dark');
  }

  // --- Pictures, links, numbers. ---

  /** Resolves once the picture is whole and at rest. */
  settled() {
    return new Promise((resolve, reject) => { this.waiting.push({ resolve, reject }); this.redraw(); });
  }

  /** Draws the colours again: a canvas has its pixels only until the browser shows them. */
  snapshot() {
    this.shade();
    return this.canvas;
  }

  get link() {
    const { canvas, page } = this;
    return writeLink(page, this.state, { scale: this.scale, size: [canvas.width, canvas.height], background: page.background, streamed: Boolean(page.site) });
  }

  ray(pixel) { return rayOf(this.state.camera, pixel, this.canvas.width, this.canvas.height); }
  /** Probe's answer for the ray of a pixel; null: none to be had now. */
  probed(pixel) {
    const ray = this.ray(pixel), parts = !this.ready || this.busy ? null : this.source.along(ray);
    return parts && this.probe.probe(parts, this.model, ray, { transfer: this.transfer, source: rangeOf(this.model.fields[this.state.field]), clip: this.clip });
  }
  /** Sums of a pixel; null: none. */
  sums(pixel) {
    if (!this.ready || !this.drawn) return null;
    const { width } = this.renderer;  // less than the canvas's in motion
    return this.renderer.sumsAt(...pixel.map((v) => Math.floor((v * width) / this.canvas.width)));
  }
}
