// page.mjs: a streamed page without a document or a GPU: the page's own state, requests, plans and decoder, and a renderer that keeps
// what it is given. The same names as in the page, for the expressions of tests: vog, notice, failure, stream, level.
const listeners = new Map();
const elements = new Map();

/** An element as far as modules of stream/ and say() use it. */
class Element {
  constructor(id) { Object.assign(this, { id, hidden: true, text: '', watchers: [], classList: { add() {} } }); }
  get textContent() { return this.text; }
  set textContent(text) {
    this.text = text;
    for (const watcher of this.watchers) watcher();
  }
}
const find = (id) => elements.get(id) ?? elements.set(id, new Element(id)).get(id);

Object.assign(globalThis, {
  MutationObserver: class {
    constructor(seen) { this.seen = seen; }
    observe(element) { element.watchers.push(this.seen); }
  },
  addEventListener: (name, listener) => listeners.set(name, [...(listeners.get(name) ?? []), listener]),
  dispatchEvent: (event) => { for (const listener of listeners.get(event.type) ?? []) listener(event); },
  self: globalThis, window: globalThis,
});
Object.defineProperty(globalThis, 'navigator', { value: { onLine: true } });
Object.defineProperty(globalThis, 'failure', { get: () => ({ hidden: find('failure').hidden }) });
for (const id of ['notice', 'stream']) globalThis[id] = find(id);

const renderer = {
  upload: (instances) => ({ count: instances.length / instanceFloats, instances, fields: new Map() }),
  uploadField: (gpu, field, data, vector) => gpu.fields.set(field, { data, vector, light: null }),
  release() {}, releaseLight(field) { field.light = null; }, releaseField: (gpu, place) => gpu.fields.delete(place),
};

/** Opens a page of `vog page -o FOLDER/`, or of one with --from. */
globalThis.openPage = async (url, fragment, width, height) => {
  const html = await (await fetch(url)).text(), text = /<script[^>]*id="page"[^>]*>([^]*?)<\/script>/.exec(html)[1];
  const page = JSON.parse(text), element = { dataset: {} };
  Object.assign(globalThis, {
    location: new URL(url), origin: new URL(url).origin,
    document: { getElementById: find, baseURI: url, documentElement: element, body: find('body') },
  });
  const state = firstState(page, false), picture = { width, height };
  let waiting = [], drawing = 0;
  const change = (part) => {
    const before = { ...state };
    Object.assign(state, changedState(page, before, part));
    if (['model', 'field', 'show'].some((key) => state[key] !== before[key])) source.load();
    redraw();
  };
  const draw = () => {
    drawing = 0;
    const there = source.now(false);
    if (!source.complete) return;
    element.dataset.drawn = there.count;
    for (const resolve of waiting.splice(0)) resolve();
  };
  const redraw = () => { drawing ||= setTimeout(draw); };
  const source = new Site(page, new Decoder(), {
    state: () => state, renderer: () => renderer, size: () => [picture.width, picture.height],
    clip: () => ({ box: state.clip, planes: state.planes }), transfer: () => state.transfers[state.field], editing: () => 0, changed: redraw,
    say, fail: (line) => giveUp(`${line}.`), show: showStream,
    refuse: (line) => {
      change({ show: 'T' });
      say(`This quantity cannot be shown: ${line}.`, 12);
    },
  });
  globalThis.picture = picture;
  globalThis.vog = {
    state, change, page, source, settled: () => new Promise((resolve) => { waiting.push(resolve); redraw(); }),
    resize: (...size) => { [picture.width, picture.height] = size; redraw(); },
  };
  change(partOfLink(page, state, readLink(fragment), state.camera).part);
  source.load();
};
