// element.js: the element <vog-view>, a view in other people's pages and in vog's own. Its attributes and properties are the words of a request.
import { Decoder } from '../model/decoder.js';
import { Site, asked, awayLine, placeOf } from '../stream/site.js';
import { Requests } from '../stream/requests.js';
import { areNumbers, isObject, parsedJson, refuse } from '../stream/rows.js';
import { cannotRead, siteOf } from '../stream/source.js';
import { pictureWords, readLink, takeWord, volumeWords } from '../link/link.js';
import { requestOf } from '../link/request.js';
import { attachKeys } from '../input.js';
import { Readout } from '../readout.js';
import { numberText, shows } from '../quantity.js';
import { Viewer } from './viewer.js';
import { motions } from './motions.js';

/** Words of a view beside those of a request: their names in links, and the values of a view without them. */
const own = {
  model: ['model', 1], exposure: ['exposure', 1], pixel_error: ['error', 1], memory: ['memory', 150], most: ['most', 2e6], subframes: ['subframes', 8],
  still: ['still', false],
};
const words = [...pictureWords, ...volumeWords, 'light_weights', 'background', ...Object.keys(own)];
const cameraWords = ['camera.eye', 'camera.look_at', 'camera.up', 'camera.fov_degrees', 'camera.orthographic_width'];
const wordOf = (name) => name.replaceAll('-', '_'), hyphened = (word) => word.replaceAll('_', '-');
const cameraNames = [...new Set([...cameraWords, ...cameraWords.map(hyphened)])];
const nothing = () => ({ settings: {}, request: {}, problems: [] });
const style = `
:host { display: block; position: relative; aspect-ratio: 16 / 10; min-width: 0; contain: content; font: 13px/1.45 system-ui, sans-serif; }
:host([hidden]) { display: none; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; outline: none; touch-action: var(--touch, pan-y); cursor: grab; user-select: none; -webkit-user-select: none; }
canvas:active { cursor: grabbing; }
canvas:focus-visible { outline: 2px solid #3b82d6; outline-offset: -2px; }
p { position: absolute; left: 12px; right: 12px; bottom: 12px; margin: 0 auto; padding: 6px 12px; border-radius: 8px; width: fit-content; box-sizing: border-box;
overflow-wrap: anywhere; background: #16191d; color: #e8eaed; }
p.light { background: #fff; color: #1c2126; box-shadow: 0 0 0 1px rgb(0 0 0 / .2); }
p[hidden] { display: none; }
span { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
`;

/** Throws unless numbers are where a view needs them. */
function checkNumbers(of, counts, where) {
  for (const [key, count] of Object.entries(counts))
    if (!areNumbers(count > 1 ? of?.[key] : [of?.[key]], count)) refuse(`${where}: ${key}`, of?.[key], count > 1 ? `${count} numbers` : 'a number');
}

/**
 * The page of models that are nothing but an address.
 * about   what a view of them begins with, as vog page and vog pack have written it: {camera, upright, chosenView, models}
 * models  their descriptions
 * site    of Site
 */
function pageOf({ lightWeights, ...given }, about, models, { steps, ...site }, name) {
  if (!isObject(about) || !Array.isArray(about.models) || about.models.length !== models.length)
    refuse(`${name}: page`, about ?? undefined, `that of ${site.file ? 'vog pack MODEL -o FILE.vogz --hierarchy --deflate' : 'vog page MODEL -o FOLDER/'}`);
  const { camera, upright, chosenView, models: entries } = about;
  checkNumbers(about, { upright: 3 }, name);
  checkNumbers(camera, { eye: 3, look_at: 3, up: 3 }, `${name}: camera`);
  entries.forEach((entry, n) => {
    const where = `${name}: models[${n}]`;
    checkNumbers(entry, { center: 3, unit: 1, cutoff: 1, limits: 4, subframeLimits: 4, extinction: 1, lowColumn: 1, mostColumn: 1 }, where);
    checkNumbers(entry.box, { center: 3, half: 3, radius: 1 }, `${where}.box`);
    if (!Array.isArray(entry.fields)) refuse(`${where}.fields`, entry.fields, 'a list');
    entry.fields.forEach((field, k) => checkNumbers(field, { lower: 1, upper: 1, reference: 1, scale: 1, ...(!field?.vector && { unitDistance: 1, values: 2 }) }, `${where}.fields[${k}]`));
  });
  return {
    ...given, maps: [...given.maps], title: models[0].name, picture: { camera, light_weights: lightWeights }, upright, chosenView: chosenView === true,
    systemBackground: false, background: [0, 0, 0, 0], steps, site, models: entries.map((entry, n) => ({ ...entry, name: models[n].name, levels: [] })),
  };
}

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
    #isFlat = false;
    #isBegun = false;    // whether `ready` waits for a model, or has one

    constructor() {
      super();
      const root = this.attachShadow({ mode: 'open' }), sheet = new CSSStyleSheet();
      sheet.replaceSync(style);
      root.adoptedStyleSheets = [sheet];
      this.#line.setAttribute('role', 'status');
      this.#line.hidden = true;
      this.#described.id = 'described';
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
      if (before === value) return;
      if (name === 'src') return this.#reopen();
      if (name === 'label') return this.#describe();
      const word = wordOf(name), found = nothing();
      if (word.startsWith('camera')) {
        // What the removed attribute said is the first view's again.
        if (value === null) this.#take({ ...nothing(), request: { camera: null } });
        found.request.camera = this.#cameraOfAttributes();
      }
      else if (value === null && own[word]) takeWord(found, ...own[word]);
      else Object.assign(found, readLink(`#${own[word]?.[0] ?? word}${value === '' ? '' : `=${encodeURIComponent(value ?? '')}`}`));
      this.#take(found);
    }
    #cameraOfAttributes() {
      const read = (name) => readLink(`#${wordOf(name)}=${encodeURIComponent(this.getAttribute(name))}`).request.camera;
      const given = ['camera', ...cameraNames].filter((name) => this.hasAttribute(name)).map(read);
      return given.length > 0 ? Object.assign({}, ...given) : null;
    }

    get src() { return this.getAttribute('src') ?? ''; }
    set src(address) { this.setAttribute('src', address); }
    /** The files of a site's folder in place of an address: (name) => bytes, or their promise. */
    get files() { return this.#files; }
    set files(read) {
      this.#files = read;
      this.#reopen();
    }
    get label() { return this.getAttribute('label') ?? ''; }
    set label(text) { this.setAttribute('label', text); }

    // --- The author's side. ---

    /** Settles with the first picture, or with the error that there is none. */
    get ready() { return this.#ready; }

    /** Sets words of a request, and the view's own. Returns a line for each that cannot be. */
    set(settings) {
      const found = nothing();
      if (!isObject(settings)) return this.#take({ ...found, problems: [`set(${settings}): expected words, as { show: 'T' }`] });
      for (const [key, value] of Object.entries(settings)) {
        const word = wordOf(key);
        if (word === 'size') found.request.size = value;  // to read the camera by
        else if (words.includes(word)) takeWord(found, own[word]?.[0] ?? word, value);
        else found.problems.push(`${key}: expected one of ${words.join(', ')}`);
      }
      return this.#take(found);
    }
    /** Value of a word. */
    get(word) {
      const view = this.#view, [key] = own[word] ?? [];
      if (!view || !key) return this.request?.[word] ?? this.#asked.request[word] ?? this.#asked.settings[key] ?? own[word]?.[1] ?? null;
      if (key === 'model') return view.state.model + 1;
      return (key === 'error' ? view.state.pixelError : view.state[key]) ?? own[word][1];
    }

    /** The request of the picture, as set() takes it; null before there is a model. */
    get request() {
      const view = this.#view;
      if (!view) return null;
      const { canvas: { width, height }, page: { background } } = view;
      return requestOf(view.page, view.state, { scale: view.scale, size: [width, height], background });
    }
    /** The same as a link's words, from # on, for pages and `vog render --request`. */
    get link() { return this.#view?.link ?? ''; }
    set link(text) { this.#take(readLink(text)); }
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
      if (!view) throw new Error('there is no model');
      await view.settled();
      return new Promise((done, fail) => {
        view.snapshot().toBlob((blob) => (blob ? done(blob) : fail(new Error('the browser has no memory for the picture'))), 'image/png');
      });
    }

    /** Ends: frees memory, ends the worker and what is under way. Another src begins anew. */
    dispose() {
      this.#opening?.abort();
      this.#view?.dispose();
      this.#view?.canvas.remove();
      this.#opening = this.#view = null;
      cancelAnimationFrame(this.#frame);
      this.#frame = 0;
      this.#say('', 0);
    }

    // --- Opening. ---

    #renew() {
      this.#ready = new Promise((resolve, reject) => { this.#settle = { resolve, reject }; });
      this.#ready.catch(() => {});  // the event tells those who do not wait
    }

    #reopen() {
      this.dispose();
      if (!this.isConnected) return;
      const has = Boolean(this.src || this.#files);
      if (this.#isBegun) {
        this.#settle.reject(new Error(has ? 'another model is opened' : 'no model'));
        this.#renew();
      }
      this.#isBegun = has;
      if (!has) return;
      const { signal } = this.#opening = new AbortController();
      this.#open(signal).catch((error) => { if (!signal.aborted) this.#fail(`The model cannot be read: ${error.message}.`); });
    }

    async #open(signal) {
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
      new Readout(view.canvas, view, (lines) => this.#tell('probe', { lines }));
      this.#apply(this.#asked);
      this.#describe();
      view.start();
    }

    /**
     * The Viewer of models that a page describes, still to be started. vog's own pages surround it with their controls, keys and lines.
     * of  {Models: the class of levels.js or site.js, panel: whether controls are shown, tell: of Viewer}
     */
    around(page, { Models, panel, tell = {} }) {
      const canvas = document.createElement('canvas');
      canvas.tabIndex = 0;
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-describedby', 'described');
      this.#name(canvas, page);
      this.shadowRoot.prepend(canvas);
      const view = this.#view = new Viewer(canvas, { page, shaders: given.shaders, decoder: new Decoder(() => this.constructor.worker()), Models, panel }, {
        say: (text, seconds) => this.#warn(text, seconds), fail: (text) => this.#fail(text), resized: () => this.#resized(canvas), playing: () => false,
        status: (status) => this.#tell('progress', status), ground: (name) => { this.#line.className = name; }, ...tell,
        shown: () => {
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
          tell.drawn?.(count);
        },
      });
      view.state.camera = view.firstView;
      return view;
    }

    // --- Changes. ---

    #take(found) {
      Object.assign(this.#asked.settings, found.settings);
      const { size, ...request } = found.request;
      Object.assign(this.#asked.request, request);
      return this.#apply(found);
    }

    #apply({ settings, request, problems: before }) {
      const view = this.#view, { background, ...others } = request, isSystem = background === 'system', { clientWidth, clientHeight } = view?.canvas ?? {};
      // The lens of view.camera is that of the canvas.
      const problems = view ? view.apply({ settings, request: { size: [clientWidth, clientHeight], ...(isSystem ? others : request) }, problems: before }) : before;
      if (view && isSystem) {
        view.page.systemBackground = true;
        view.followSystem();
      }
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
      this.dispose();
      this.#say(text, 0);
      this.#settle.reject(new Error(text));
      this.#tell('error', { message: text, fatal: true });
    }

    /** Names the canvas for those who hear it, before its first picture too. */
    #name(canvas, { title }) {
      canvas.setAttribute('aria-label', `${this.label || title}. Drag or press arrow keys to turn, pinch or press W and S to come nearer.`);
    }
    /** What is seen, for those who hear it. */
    #describe() {
      const view = this.#view;
      if (!view) return;
      const { show, field, camera, map } = view.state, name = shows(view.model).find(([one]) => one === show)[1], of = show === 'T' || show === 'column' ? '' : ` of ${view.model.fields[field]?.name}`;
      const from = camera.eye.map((v, k) => numberText(v - camera.at[k])).join(', ');
      this.#name(view.canvas, view.page);
      this.#described.textContent = `${name}${of} in ${map}, ${view.count.toLocaleString('en')} Gaussians, seen from ${from}.`;
    }
  }
  for (const word of words)
    Object.defineProperty(VogView.prototype, word, { get() { return this.get(word); }, set(value) { this.set({ [word]: value }); }, enumerable: true });
  return VogView;
}
