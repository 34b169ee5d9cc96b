// element.js: the element <vog-view>, a view in other people's pages and in vog's own. Its attributes and properties are the words of a request.
import { Decoder } from '../model/decoder.js';
import { Site, asked, awayLine, mostGaussians, mostMegabytes, placeOf } from '../stream/site.js';
import { Requests } from '../stream/requests.js';
import { isObject, parsedJson } from '../stream/rows.js';
import { cannotRead, siteOf } from '../stream/source.js';
import { pictureWords, readLink, takeText, takeWord, unsetOf, volumeWords } from '../link/link.js';
import { joined, requestOf, valuesOf } from '../link/request.js';
import { attachKeys } from '../input.js';
import { Readout } from '../readout.js';
import { numberText, shows } from '../quantity.js';
import { pageOf } from './described.js';
import { Viewer } from './viewer.js';
import { motions } from './motions.js';

/** Words of a view beside those of a request. */
const own = ['model', 'exposure', 'pixel_error', 'memory', 'most', 'subframes', 'still'];
const words = [...pictureWords, ...volumeWords, 'light_weights', 'background', ...own];
/** Words that an attribute without a value switches on. */
const flags = ['blend', 'shadows', 'ambient_occlusion', 'clip_lights', 'still'];
/** Name of a word in links. */
const keyOf = (word) => (word === 'pixel_error' ? 'error' : word);
const cameraWords = ['camera.eye', 'camera.look_at', 'camera.up', 'camera.fov_degrees', 'camera.orthographic_width'];
const wordOf = (name) => name.replaceAll('-', '_'), hyphened = (word) => word.replaceAll('_', '-');
const cameraNames = [...new Set([...cameraWords, ...cameraWords.map(hyphened)])];
const nothing = () => ({ settings: {}, request: {}, problems: [] });
const style = `
:host { display: block; position: relative; aspect-ratio: 16 / 10; min-width: 0; contain: content; font: 13px/1.45 system-ui, sans-serif; }
:host([hidden]) { display: none; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; outline: none; touch-action: var(--touch, pan-y); cursor: grab; user-select: none; -webkit-user-select: none; }
canvas:active { cursor: grabbing; }
canvas:focus { touch-action: none; }
canvas.still { touch-action: auto; cursor: auto; }
canvas:focus-visible { outline: 2px solid #3b82d6; outline-offset: -2px; }
p { position: absolute; left: 12px; right: 12px; bottom: 12px; margin: 0 auto; padding: 6px 12px; border-radius: 8px; width: fit-content; box-sizing: border-box;
overflow-wrap: anywhere; background: #16191d; color: #e8eaed; }
p.light { background: #fff; color: #1c2126; box-shadow: 0 0 0 1px rgb(0 0 0 / .2); }
p[hidden] { display: none; }
span { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
`;

/**
 * The class of the element.
 * given  {shaders: texts by file name, page: {maps, map, slabs, leastColumn, lightWeights}, for views of an address, worker(): a new one, or throws}
 */
export function elementOf(given) {
  class VogView extends (globalThis.HTMLElement ?? Object) {
    static observedAttributes = ['src', 'label', ...words.map(hyphened), ...cameraNames];
    /** Makes the worker that decodes; where it throws, the page's own thread decodes. */
    static worker = given.worker;

    #line = document.createElement('p');
    #described = document.createElement('span');
    #files = null;
    #asked = nothing();  // settings of attributes and of set(), as of readLink
    #opening = null;     // of the current src
    #view = null;
    #settle = null;
    #ready = null;
    #hiding = 0;
    #frame = 0;
    #readout = null;
    #isFlat = false;
    #isBegun = false;    // whether `ready` waits for a model, has one, or has lost it
    #internals = this.attachInternals?.();

    constructor() {
      super();
      const root = this.attachShadow({ mode: 'open' }), sheet = new CSSStyleSheet();
      sheet.replaceSync(style);
      root.adoptedStyleSheets = [sheet];
      this.#line.setAttribute('role', 'status');
      this.#line.hidden = true;
      this.#described.id = 'described';
      this.#described.setAttribute('aria-hidden', 'true');  // heard with the canvas, and once
      root.append(this.#line, this.#described);
      this.#renew();
    }

    // --- The document's side. ---

    connectedCallback() {
      // Properties that were set before the element was defined.
      for (const word of ['src', 'files', 'link', 'label', ...words]) {
        if (!Object.hasOwn(this, word)) continue;
        const value = this[word];
        delete this[word];
        this[word] = value;
      }
      if (!this.#opening) this.#reopen();
    }
    disconnectedCallback() {
      // An element that moves is in the document again at once.
      queueMicrotask(() => { if (!this.isConnected) this.dispose(); });
    }
    attributeChangedCallback(name, before, value) {
      if (name === 'src' && !(before === value && this.#opening)) return this.#reopen();
      if (before === value) return;
      if (name === 'label') return this.#describe();
      const word = wordOf(name), found = nothing(), isCamera = word.startsWith('camera');
      // What a removed attribute said is the default's again.
      if (value === null) this.set({ [isCamera ? 'camera' : word]: null });
      const names = isCamera ? ['camera', ...cameraNames] : [name];
      this.#take(this.#takenOf(names.filter((one) => this.hasAttribute(one)), found));
    }
    /** Takes attributes into the answer of readLink; empty ones are true or the default. */
    #takenOf(names, found) {
      for (const name of names) {
        const text = this.getAttribute(name), word = wordOf(name);
        takeText(found, keyOf(word), text === '' && flags.includes(word) ? true : text, word);
      }
      return found;
    }

    get src() { return this.getAttribute('src') ?? ''; }
    set src(address) { this.setAttribute('src', address ?? ''); }
    /** The files of a site's folder in place of an address: (name) => bytes, or their promise. */
    get files() { return this.#files; }
    set files(read) {
      this.#files = read;
      this.#reopen();
    }
    get label() { return this.getAttribute('label') ?? ''; }
    set label(text) { this.setAttribute('label', text ?? ''); }

    // --- The author's side. ---

    /** Settles with the first picture, or with the error that there is none. */
    get ready() { return this.#ready; }

    /** Sets words of a request, and the view's own. Returns a line for each that cannot be. */
    set(settings) {
      const found = nothing();
      if (!isObject(settings)) return this.#take({ ...found, problems: [`set(${settings}): expected words, as { show: 'T' }`] });
      for (const [key, value] of Object.entries(settings)) {
        const word = wordOf(key);
        if (value === undefined) continue;
        if (word === 'size') found.request.size = value;  // to read the camera by
        else if (words.includes(word)) takeWord(found, keyOf(word), value, word);
        else found.problems.push(`${key}: expected one of ${words.join(', ')}`);
      }
      return this.#take(found);
    }
    /** Value of a word. */
    get(word) {
      const view = this.#view, { settings, request } = this.#asked, usual = { memory: mostMegabytes, most: mostGaussians }[word];
      if (!own.includes(word)) return (view ? valuesOf(view.page, view.state, this.#shown) : request)[word] ?? null;
      if (!view) return settings[keyOf(word)] ?? unsetOf(keyOf(word)) ?? usual;
      return { ...view.state, model: view.state.model + 1, pixel_error: view.state.pixelError }[word] ?? usual;
    }
    get #shown() {
      const { canvas: { width, height }, page: { background }, scale } = this.#view;
      return { scale, size: [width, height], background };
    }

    /** The request of the picture, as set() takes it; null before there is a model. */
    get request() {
      const view = this.#view;
      return view && requestOf(view.page, view.state, this.#shown);
    }
    /** The same as a link's words, from # on, for pages and `vog render --request`. */
    get link() { return this.#view?.link ?? ''; }
    set link(text) { this.#take(readLink(`${text}`)); }
    /** What there is to be shown: [{name, shows, fields: [{name, unit, lower, upper}]}]. */
    get models() {
      const fieldOf = ({ name, unit, lower, upper }) => ({ name, unit, lower, upper });
      return (this.#view?.page.models ?? []).map((model) => ({ name: model.name, shows: shows(model).map(([show]) => show), fields: model.fields.map(fieldOf) }));
    }

    /** Calls a function of the detail at 'change', 'error', 'progress' or 'probe'; returns a function that ends this. */
    on(name, listener) {
      const call = (event) => listener(event.detail);
      this.addEventListener(name, call);
      return () => this.removeEventListener(name, call);
    }

    /** A PNG of the whole picture at rest. */
    async picture() {
      await this.#ready;
      const view = this.#view;
      if (!view || !this.isConnected) throw new Error('the view has been removed');
      if (view.canvas.clientWidth * view.canvas.clientHeight === 0) throw new Error('the element is hidden or has no size: show it first');
      await view.settled();
      return new Promise((done, fail) => {
        view.snapshot().toBlob((blob) => (blob ? done(blob) : fail(new Error('the browser has no memory for the picture'))), 'image/png');
      });
    }

    /** Ends: frees memory, ends the worker and what is under way. Another src begins anew. */
    dispose() { this.#end('the view has been removed', true); }
    /** Rejects `ready` where it waits; isLast: and what `ready` is from now on. */
    #end(reason, isLast) {
      const error = new Error(reason);
      this.#opening?.abort();
      this.#view?.dispose();
      this.#view?.canvas.remove();
      this.#opening = this.#view = this.#readout = null;
      cancelAnimationFrame(this.#frame);
      this.#frame = 0;
      this.#say('', 0);
      this.#describe();
      if (this.#isBegun) {
        this.#settle.reject(error);
        this.#renew();
      }
      if (isLast) this.#settle.reject(error);
      this.#isBegun = isLast;
    }

    // --- Opening. ---

    #renew() {
      this.#ready = new Promise((resolve, reject) => { this.#settle = { resolve, reject }; });
      this.#ready.catch(() => {});  // the event tells those who do not wait
    }

    #reopen() {
      this.#end('another model is opened', false);
      this.#isBegun = this.isConnected && Boolean(this.src || this.#files);
      if (!this.#isBegun) return;
      const { signal } = this.#opening = new AbortController();
      this.#open(signal).catch((error) => { if (!signal.aborted) this.#fail(`The model cannot be read: ${error.message}.`); });
    }

    async #open(signal) {
      if (this.#files && typeof this.#files !== 'function') throw new Error('files: expected a function (name) => bytes');
      const site = this.#files ? { manifest: 'manifest.json', base: 'files:/', files: this.#files } : siteOf(this.src), source = placeOf(site), line = cannotRead(source);
      if (line) return this.#fail(`${line}.`);
      const requests = new Requests({ changed() {}, away: (isAway, reason) => this.#warn(isAway ? awayLine(source.base, reason, true) : '', 0) });
      signal.addEventListener('abort', () => requests.dispose());
      const [first, page] = asked(source, requests, [source.first(), ...source.beside()]);
      const bytes = await first, { models, steps, about = parsedJson(await page, 'page.json') } = await source.models(bytes);
      if (signal.aborted) return;
      requests.dispose();
      this.#start({ ...pageOf(given.page, about, models, { ...site, steps }, source.name ?? 'page.json'), begun: { source, bytes, loaded: requests.loaded } });
    }

    #start(page) {
      const view = this.around(page, { Models: Site, panel: false });
      // The wheel and vertical swipes are the surrounding page's until the picture has been clicked.
      view.state.embed = true;
      attachKeys(view.canvas, motions(view), view.ended.signal);
      this.#readout = new Readout(view.canvas, view, (lines) => this.#tell('probe', { lines }));
      const { problems } = this.#takenOf(own.map(hyphened).filter((name) => this.hasAttribute(name)), nothing());
      this.#apply({ ...this.#asked, problems });
      this.#describe();
      view.start();
    }

    /**
     * The Viewer of models that a page describes, still to be started. vog's own pages surround it with their controls, keys and lines.
     * of  {Models: the class of levels.js or site.js, panel: whether controls are shown, tell: of Viewer}
     */
    around(page, { Models, panel, tell = {} }) {
      const canvas = document.createElement('canvas');
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-describedby', 'described');
      this.#name(canvas, page, { model: 0, still: false });
      this.shadowRoot.prepend(canvas);
      const view = this.#view = new Viewer(canvas, { page, shaders: given.shaders, decoder: new Decoder(() => this.constructor.worker()), Models, panel }, {
        say: (text, seconds) => this.#warn(text, seconds), fail: (text) => this.#fail(text), resized: () => this.#resized(canvas), playing: () => false,
        status: (status) => this.#tell('progress', status), ground: (name) => { this.#line.className = name; }, ...tell,
        reopen: () => this.#reopen(),
        shown: () => {
          this.#name(canvas, page, view.state);
          tell.shown?.();
          this.#changed();
        },
        took: (ms) => {
          if (view.count > 0) this.#settle.resolve(this);
          tell.took?.(ms);
        },
        drawn: (count) => {
          this.#settle.resolve(this);
          this.#describe();
          this.#readout?.renew();
          tell.drawn?.(count);
        },
      });
      view.state.camera = view.firstView;
      return view;
    }

    // --- Changes. ---

    #take(found) {
      const problems = this.#apply(found), { model, ...settings } = found.settings;
      Object.assign(this.#asked.settings, settings, model <= (this.#view?.page.models.length ?? Infinity) && { model });
      this.#asked.request = joined(this.#asked.request, found.request, problems, this.#view?.state.asked.words);
      return problems;
    }

    #apply({ settings, request, problems: before }) {
      const view = this.#view, { clientWidth, clientHeight } = view?.canvas ?? {};
      // The lens of view.camera is that of the canvas.
      const problems = view ? view.apply({ settings, request: { ...request, size: request.size ?? [clientWidth, clientHeight] }, problems: before }) : before;
      if (problems.length > 0) this.#warn(`Not in this picture: ${problems.join('; ')}`, 12);
      return problems;
    }

    /** One event for all changes of a frame. */
    #changed() {
      this.#frame ||= requestAnimationFrame(() => {
        this.#frame = 0;
        if (this.#view) this.#tell('change', { request: this.request });
      });
    }

    #resized({ clientWidth: width, clientHeight: height }) {
      // A hidden element has no box at all.
      const isFlat = width * height === 0 && this.getClientRects().length > 0;
      if (isFlat && !this.#isFlat) this.#warn(`The element is ${width} x ${height} pixels, expected a width and a height`, 0);
      if (!isFlat && this.#isFlat) this.#warn('', 0);
      this.#isFlat = isFlat;
    }

    // --- Words. ---

    #tell(name, detail) { this.dispatchEvent(new CustomEvent(name, { detail })); }

    /** Shows a line for some seconds; 0: until the next; '': none. */
    #say(text, seconds) {
      clearTimeout(this.#hiding);
      this.#line.textContent = text;
      this.#line.hidden = text === '';
      if (text && seconds > 0) this.#hiding = setTimeout(() => this.#say('', 0), 1000 * seconds);
    }
    #warn(text, seconds) {
      this.#say(text, seconds);
      if (text) this.#tell('error', { message: text, fatal: false });
    }
    /** There is no picture. */
    #fail(text) {
      this.#end(text, true);
      this.#say(text, 0);
      this.#tell('error', { message: text, fatal: true });
    }

    /** Names the canvas for those who hear it, before its first picture too. */
    #name(canvas, { title, models }, { model, still }) {
      const name = this.label || (models.length > 1 ? models[model].name : title);
      canvas.setAttribute('aria-label', `${name.trim().replace(/\.$/, '')}.${still ? '' : ' Drag or press arrow keys to turn, pinch or press W and S to come nearer.'}`);
      canvas.classList.toggle('still', still);
      canvas.tabIndex = still ? -1 : 0;
    }
    /** What is seen, for those who hear it. */
    #describe() {
      const view = this.#view;
      if (this.#internals) Object.assign(this.#internals, { role: !view && this.label ? 'group' : null, ariaLabel: view ? null : this.label || null });
      if (!view) return;
      const { show, field, camera, map } = view.state, name = shows(view.model).find(([one]) => one === show)[1], of = show === 'T' || show === 'column' ? '' : ` of ${view.model.fields[field]?.name}`;
      const from = camera.eye.map((v, k) => numberText(v - camera.at[k])).join(', ');
      this.#name(view.canvas, view.page, view.state);
      this.#described.textContent = `${name}${of} in ${map}, ${view.count.toLocaleString('en')} Gaussians, seen from ${from}.`;
    }
  }
  for (const word of words)
    Object.defineProperty(VogView.prototype, word, { get() { return this.get(word); }, set(value) { this.set({ [word]: value }); }, enumerable: true });
  return VogView;
}
