// main.js: state of the page, scheduling of frames, commands.
import { isSame, mul, normalized, sub } from './vectors.js';
import { carriedOver, filling, fitted, flown, orbited, rolled, seenFrom } from './camera.js';
import { withOtherProjection } from './camera.js';
import { Decoder } from './model/decoder.js';
import { Levels } from './model/levels.js';
import { Site } from './stream/site.js';
import { showStream } from './stream/status.js';
import { fading, reversed } from './picture/colors.js';
import { overRange } from './picture/transfer.js';
import { Renderer } from './picture/renderer.js';
import { Slabs } from './picture/slabs.js';
import { Probe, rayOf } from './picture/probe.js';
import { automaticScale, automaticTransfer, comparable, fieldPlace, inSlabs, quantityNumber, sumsOf } from './quantity.js';
import { changedState, firstState, partOfLink, readLink, writeLink } from './link/link.js';
import { attachKeys, attachPointers } from './input.js';
import { Controls, giveUp, say } from './controls.js';
import { Overlay } from './overlay.js';
import { Handles } from './handles.js';
import { Player } from './player.js';
import { Outer } from './link/outer.js';
import { recordIn } from './link/record.js';
import { Readout } from './readout.js';
import { remapped } from './editor.js';

const find = (id) => document.getElementById(id);
const page = JSON.parse(find('page').textContent);
const sources = Object.fromEntries(
  [...document.querySelectorAll('script[data-shader]')].map((s) => [s.dataset.shader, s.textContent]));
const canvas = find('picture');
find('loading').remove();
const narrow = () => window.matchMedia('(max-width: 640px), (max-height: 420px)').matches;

const state = firstState(page, !narrow()), authored = state.camera;

// --- What is shown. ---

const models = () => comparable(page, state.model);
const mapNow = () => {
  const map = page.maps.find(({ name }) => name === state.map);
  return state.reverse ? reversed(map) : map;
};
const clipNow = () => ({ box: state.clip, planes: state.planes });
const scaleNow = () => (state.scale?.low === undefined ? automaticScale(models(), state, state.scale?.log) : state.scale);
let automatic = null;  // [key, transfer function] without edits
/** The transfer function of the shown field. */
function transferNow() {
  if (state.show !== 'volume') return null;
  if (state.transfers[state.field]) return state.transfers[state.field];
  const key = [page.steps ? 0 : state.model, state.field, state.map, state.reverse].join(' ');
  if (automatic?.[0] !== key) automatic = [key, automaticTransfer(models(), state.field, mapNow())];
  return automatic[1];
}

// --- Drawing. What sumsOf lists draws the model anew; all else only finishes the sums. ---

const restMs = 200;       // time without motion or edits after which the picture counts as at rest
const slowMs = 50;        // frames that take longer have fewer pixels during edits, where not all their sums have room
const patienceMs = 100;   // no further sub-frames after one that took longer

let renderer = null, slabs = null, half = false, lost = false;
let drawn = null;              // sumsOf the current sums
let count = 0;                 // Gaussians of the last frame
let loads = 0;
let moving = 0, editing = 0;   // timers of motion and of edits of what comes after the sums
let edited = false, coarse = false;  // whether there were edits; whether this one has fewer pixels
let frame = 0, inFlight = false, frameMs = 0;
let stale = false;             // something changed while a frame was in flight
let waiting = [];              // callbacks that wait for a settled picture

function request() {
  if (!frame && !inFlight && renderer && !lost) frame = requestAnimationFrame(draw);
}

const decoder = new Decoder(find('reader').textContent + find('worker').textContent);
/** The models: what there is of them to draw. Pages without a site have no modules of stream/. */
const source = new (page.site ? Site : Levels)(page, decoder, {
  state: () => state, renderer: () => (lost ? null : renderer), size: () => [canvas.width, canvas.height],
  clip: clipNow, transfer: transferNow, editing: () => editing, changed: redraw,
  say, fail: (text) => giveUp(`${text}.`), show: (status) => { showStream(status); controls.showDetail(source.detail()); },
  refuse: (line) => {
    change({ show: 'T' });
    say(`This quantity cannot be shown: ${line}.`, 12);
  },
});
const busy = () => Boolean(moving || player?.playing);

const rangeOf = ({ reference, scale, isMeasure, background }) => ({ reference, unit: scale, isMeasure, background });

const slabsNow = () => page.slabs[state.show !== 'volume' ? 1 : state.light.on || state.light.shadows || state.light.occlusion ? 2 : 0];
/** What pictures are finished with after their slabs are drawn. */
const finishNow = () => (state.show === 'volume' ? [transferNow(), state.light, isDraft()] : []);
/** Whether ambient occlusion uses larger cells. */
const isDraft = () => state.light.occlusion && Boolean(editing || !source.complete);
/** Which sums there are, and what may be edited after them: the exposure of streamed models decides what is hidden. */
const editsNow = () => [[state.show, state.field, state.model].join(' '), page.site && state.show === 'T' && state.exposure, ...finishNow()];

/** Adds one sub-frame of the shown quantity. */
function addSums(parts, of) {
  const model = page.models[state.model], field = fieldPlace(state), { camera } = state, clip = clipNow();
  if (inSlabs(state.show)) {
    slabs ??= new Slabs(renderer);
    slabs.add(parts, model, camera, {
      field, transfer: transferNow(), light: state.light, clip, slabs: slabsNow(), of, keep: state.panel || edited,
      source: rangeOf(model.fields[field]), whole: state.show === 'volume' ? source.whole() : null, draft: isDraft(),
    });
  } else {
    renderer.addSums(parts, model, camera, { field, part: field === null ? '' : state.part, clip });
  }
}

function draw() {
  frame = 0;
  if (lost) return;
  try {
    drawNow();
  } catch (error) {
    if (lost || renderer.gl.isContextLost()) return;
    if (state.show === 'T') return giveUp(`No picture here: ${error.message}.`);
    say(`This quantity cannot be drawn here: ${error.message}.`, 12);
    change({ show: 'T' });
  }
}

function drawNow() {
  const there = source.now(busy());
  const kept = coarse && state.show === 'volume' && slabs?.shareKept({ light: state.light, slabs: slabsNow() }, canvas.width * canvas.height);
  const size = [canvas.width, canvas.height].map((n) => Math.max(1, Math.floor(Math.sqrt(kept || 1) * n))), now = sumsOf(state, there.key, size, slabsNow());
  count = there.count;
  renderer.choose(now.of, finishNow());
  renderer.resize(...size);
  if (!drawn || !isSame(now.view, drawn.view)) {
    renderer.restart();
    slabs?.restart(state.show === 'volume');
  }
  drawn = now;
  if (renderer.subframes === 0 || wantsMore()) addSums(there.parts, now.of);
  shade();
  if (inFlight) stale = true;
  else time();
}

function shade() {
  const model = page.models[state.model], source = model.fields[state.field];
  renderer.shade({
    quantity: quantityNumber(state), scale: scaleNow(), fade: state.fade, background: page.background,
    factor: state.show === 'T' ? state.exposure : state.show === 'volume' ? 1 : 1 / model.extinction,
    unit: source ? [source.reference, source.scale] : [0, 1], leastColumn: inSlabs(state.show) ? 0 : page.leastColumn * model.mostColumn,
  });
}

/** Whether to add a sub-frame. The first frame's time is ignored: it may include shader compilation. */
const wantsMore = () => !busy() && !editing && renderer.subframes < state.subframes &&
    (renderer.subframes < 2 || frameMs < patienceMs);

/** Waits until the GPU has finished the frame, measures its time, then allows the next. */
function time() {
  const { gl } = renderer, start = performance.now();
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  inFlight = true;
  const poll = () => {
    if (!lost && fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED)
      return setTimeout(poll, 2);
    gl.deleteSync(fence);
    inFlight = false;
    frameMs = performance.now() - start;
    find('count').title = `${Math.round(frameMs)} ms a frame`;
    source.frameTook(frameMs, page.site ? busy() : Boolean(moving));
    afterFrame();
  };
  setTimeout(poll, 0);
}

function afterFrame() {
  if (stale || wantsMore()) {
    stale = false;
    return request();
  }
  if (moving || editing || !source.complete) return;
  document.documentElement.dataset.drawn = count;
  for (const resolve of waiting.splice(0)) resolve();
}

function redraw() {
  stale = inFlight;
  request();
}

function startRenderer() {
  try {
    renderer = new Renderer(canvas, sources, half);
  } catch (error) {
    renderer = null;
    giveUp(`No picture here: ${error.message}. A current Firefox, Chrome or Safari on a computer or ` +
        'phone of the last years can show it.');
    return;
  }
  slabs = null;
  source.restart();
  drawn = null;
  setMap();
  if (renderer.format.bits === 16)
    say('32-bit float blending is missing on this device: sums are kept in 16-bit floats, and ' +
        'faint parts may show steps.', 12);
}

function setMap() {
  renderer?.setMap(state.show === 'T' && state.fade ? fading(mapNow()) : mapNow());
}

/** Has all that the state shows decoded, coarse first. */
async function load() {
  if (loads++ > 0 && !page.steps) say('');
  await source.load();
}

// --- Changes. ---

/** Changes part of the state; the only place that does. */
function change(part) {
  const before = { ...state }, edits = editsNow();
  Object.assign(state, changedState(page, before, part));
  if (['map', 'reverse', 'fade', 'show'].some((key) => state[key] !== before[key])) setMap();
  if ((state.map !== before.map || state.reverse !== before.reverse) && !part.transfers) recolor();
  if (renderer && (state.model !== before.model || state.field !== before.field || state.show !== before.show)) {
    load().catch((error) => giveUp(`The page cannot be read: ${error.message}.`));
  }
  if (drawn && editsNow()[0] === edits[0] && !isSame(editsNow(), edits)) edit();
  showControls();
  outer?.tell();
  redraw();
}

/** Finishes the sums that are there, until the edits rest. */
function edit() {
  coarse ||= frameMs > slowMs;
  edited = true;
  clearTimeout(editing);
  editing = setTimeout(() => {
    editing = 0;
    coarse = false;
    redraw();
  }, restMs);
}

const overlay = new Overlay(find('length'), find('axes'));
const handles = new Handles(find('handles'), {
  camera: () => state.camera, box: () => box(), clip: () => state.clip, change: (clip) => change({ clip }),
  size: () => [canvas.clientWidth, canvas.clientHeight],
  place: ({ clientX, clientY }) => { const { left, top } = canvas.getBoundingClientRect(); return [clientX - left, clientY - top]; },
});
/** Handles of the clip while its controls are open. */
function showHandles() {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  Object.assign(find('handles').style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
  handles.show(find('clip-row').open && state.panel && !state.embed);
}
find('clip-row').addEventListener('toggle', showHandles);
function showOverlay() {
  const box = canvas.getBoundingClientRect();
  find('world').style.right = `calc(${window.innerWidth - box.right}px + 14px)`;
  find('world').hidden = !state.bar;
  overlay.show(state.camera, box.width, box.height);
  showHandles();
}

function showControls() {
  showOverlay();
  find('z-up').checked = page.upright[2] > 0.5;
  controls.show(state, { scale: scaleNow(), transfer: transferNow(), detail: source.detail() });
  player?.show(state.model, page.models[state.model].name);
  readout.show();
}

/** Another map in an edited transfer function: its colours over the same values. */
function recolor() {
  const edited = state.transfers[state.field];
  if (!edited) return;
  const [from, to] = [edited.colors[0][0], edited.colors.at(-1)[0]], source = page.models[state.model].fields[state.field];
  const [low, high] = to > from ? [from, to] : [source.lower, source.upper];
  const log = source.log && low === source.values[0] && high === source.values[1];
  const { colors } = overRange(mapNow(), low, high, 1, log);
  state.transfers = { ...state.transfers, [state.field]: { ...edited, name: state.map, colors } };
}

/** An edited transfer function of the shown field, a unit of 0 for the field's own; null: the first one again. */
function setTransfer(transfer) {
  const { [state.field]: _, ...others } = state.transfers, unit = transfer?.unit || models()[0].fields[state.field]?.unitDistance;
  change({ transfers: transfer ? { ...others, [state.field]: { ...transfer, unit } } : others });
}

/** Level and width of the shown values by a drag, as radiologists have it; shares of the picture's height. */
function windowed(rightwards, upwards) {
  if (state.show === 'T') return false;
  const narrowed = (low, high) => {
    const middle = 0.5 * (low + high) - upwards * (high - low), width = (high - low) * Math.exp(2 * rightwards);
    return (v) => middle + ((v - 0.5 * (low + high)) / (high - low)) * width;
  };
  if (state.show === 'volume') {
    const transfer = transferNow(), values = [...transfer.colors, ...transfer.opacity].map(([v]) => v);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    if (high > low) setTransfer(remapped(transfer, narrowed(low, high)));
  } else {
    const scale = scaleNow(), to = narrowed(scale.low, scale.high), [low, high] = [to(scale.low), to(scale.high)];
    if (low < high && !(scale.log && low <= 0)) change({ scale: { ...scale, low, high } });
  }
  return true;
}

// --- Probe: the numbers under the pointer. ---

const probe = new Probe();
/** Probe's answer for the ray of a pixel; null: none to be had now. */
function probed(pixel) {
  const model = page.models[state.model], ray = rayOf(state.camera, pixel, canvas.width, canvas.height);
  const parts = !renderer || lost || busy() ? null : source.along(ray);
  return parts && probe.probe(parts, model, ray, { transfer: transferNow(), source: rangeOf(model.fields[state.field]), clip: clipNow() });
}
const readout = new Readout(canvas, find('probe'), {
  now: () => ({ model: page.models[state.model], state }), busy: () => moving || inFlight, ray: probed,
  sums: (pixel) => (renderer && !lost && drawn ? renderer.sumsAt(...pixel) : null),
});

function move(camera) {
  clearTimeout(moving);
  moving = setTimeout(() => {
    moving = 0;
    redraw();
  }, restMs);
  change({ camera });
}

const box = (model = state.model) => page.models[model].box;
const still = () => state.still;

/** Initial view: the author's, or the default enlarged to fill a tall screen. */
const firstView = () => (page.chosenView
  ? authored : filling(authored, box(0), canvas.clientWidth, canvas.clientHeight));

/** Applies settings, as in the address behind #; others stay. */
function follow(settings) {
  const link = readLink(settings), { part, background, problems } = partOfLink(page, state, link, firstView());
  half = link.settings.half ?? half;
  if (background) setBackground(background);
  change(part);
  if (problems.length > 0) say(`Not in this picture: ${problems.slice(0, 3).join('; ')}${problems.length > 3 ? ' …' : ''}`, 12);
}

function setBackground(color) {
  page.systemBackground = false;
  page.background = color;
  const luma = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
  document.documentElement.dataset.ground = color[3] < 0.5 ? 'clear' : luma > 0.5 ? 'light' : 'dark';
}

/** Follows a link or a request that is pasted or dropped, as text or in a file of a picture. */
async function take(event) {
  const given = event.clipboardData ?? event.dataTransfer, [file] = given.files;
  if (event.target.matches?.('input, textarea') || (!file && !given.types.includes('text/plain'))) return;
  event.preventDefault();
  const text = file ? await recordIn(file) : given.getData('text/plain');
  if (/[#{]/.test(text)) follow(text);
  else say(file ? `${file.name}: holds no record of a picture` : 'Neither a link nor a request', 8);
}

// --- Commands. ---

function picture() {
  shade();
  return canvas.toDataURL('image/png');
}

async function save() {
  if (editing) await window.vog.settled();
  const name = page.title.replace(/[^\p{L}\p{N}]+/gu, '-').replace(/^-|-$/g, '') || 'vog';
  const link = Object.assign(document.createElement('a'), { href: picture(), download: `${name}.png` });
  link.click();
}

const linkNow = () => writeLink(page, state, {
  scale: scaleNow(), size: [canvas.width, canvas.height], background: page.background, streamed: Boolean(page.site),
});

async function copyLink() {
  const text = location.href.replace(/#.*$/, '') + linkNow();
  try {
    await navigator.clipboard.writeText(text);
    say('Link to this view copied');
  } catch {
    window.prompt('Link to this view', text);
  }
}

const fly = (x, y, z) => () => {
  if (!still()) move(flown(state.camera, ...mul(0.05 * box().radius, [x, y, z])));
};
const turn = (x, y) => () => {
  if (!still()) move(orbited(state.camera, (x * Math.PI) / 36, (y * Math.PI) / 36));
};
const roll = (sign) => () => { if (!still()) move(rolled(state.camera, (sign * Math.PI) / 36)); };
const look = (axis) => (event) => {
  if (!still()) move(seenFrom(state.camera, box(), axis, event.shiftKey ? -1 : 1, page.upright));
};
const home = () => { if (!still()) move(carriedOver(firstView(), box(0), box())); };
/** The data's vertical, y or z: that of views along the axes, and of the view now. */
function stand(axis) {
  page.upright = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
  if (still()) return change({});
  const view = normalized(sub(state.camera.at, state.camera.eye));
  const along = Math.abs(view[axis]) > 0.999;
  move({ ...state.camera, up: along ? state.camera.up : page.upright });
}
const expose = (factor) => () => change({
  exposure: factor ? Math.max(1 / 64, Math.min(64, state.exposure * factor)) : 1,
});
function nextMap(event) {
  const names = page.maps.map(({ name }) => name);
  const step = event.shiftKey ? names.length - 1 : 1;
  change({ map: names[(names.indexOf(state.map) + step) % names.length] });
}

const player = page.steps ? new Player(page.models.length, change,
                                       (model) => source.isReady(model)) : null;
const controls = new Controls(page, change, {
  home, save, link: copyLink, help: () => controls.help(), transfer: setTransfer,
  panel: () => change({ panel: !state.panel }), detail: (value) => change(source.detailed(value)),
});

find('z-up').addEventListener('change', () => stand(find('z-up').checked ? 2 : 1));
attachKeys({
  w: fly(0, 0, 1), s: fly(0, 0, -1), a: fly(-1, 0, 0), d: fly(1, 0, 0),
  pageup: fly(0, 1, 0), pagedown: fly(0, -1, 0),
  arrowleft: turn(-1, 0), arrowright: turn(1, 0), arrowup: turn(0, 1), arrowdown: turn(0, -1),
  q: roll(-1), e: roll(1),
  Digit1: look(0), Digit2: look(1), Digit3: look(2),
  Digit5: () => { if (!still()) move(withOtherProjection(state.camera)); },
  home, f: () => { if (!still()) move(fitted(state.camera, box())); },
  '[': () => change(source.detailed(source.detail().value - 1)), ']': () => change(source.detailed(source.detail().value + 1)),
  '-': expose(1 / Math.SQRT2), '=': expose(Math.SQRT2), '+': expose(Math.SQRT2), Digit0: expose(0),
  ' ': () => player?.toggle(), ',': () => player?.go(state.model - 1), '.': () => player?.go(state.model + 1),
  z: (event) => {
    if (state.show === 'volume') event.shiftKey ? controls.editor.redo() : controls.editor.undo();
  },
  v: () => {
    const all = [...find('show').options].map(({ value }) => value);
    change({ show: all[(all.indexOf(state.show) + 1) % all.length] });
  },
  m: nextMap, i: () => change({ reverse: !state.reverse }), b: () => change({ fade: !state.fade }),
  n: () => change({ model: (state.model + 1) % page.models.length }),
  p: save, c: copyLink, l: () => change({ bar: !state.bar }),
  h: () => change({ panel: !state.panel }), '?': () => controls.help(),
});
attachPointers(canvas, {
  camera: () => state.camera, move, still, windowed, embedded: () => state.embed,
  leastDistance: () => 0.02 * box().radius,
});

canvas.addEventListener('webglcontextlost', (event) => {
  event.preventDefault();
  lost = true;
  say('The graphics driver restarts …', 0);
});
canvas.addEventListener('webglcontextrestored', () => {
  lost = false;
  say('');
  startRenderer();
  redraw();
});
window.addEventListener('hashchange', () => follow(location.hash));
window.addEventListener('paste', take);
window.addEventListener('drop', take);
window.addEventListener('dragover', (event) => event.preventDefault());
const outer = new Outer(window, { now: linkNow, follow });

/** Sets the canvas to the screen's resolution, at most two pixels per CSS pixel. */
function fitCanvas() {
  showOverlay();
  const scale = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * scale));
  const height = Math.max(1, Math.round(canvas.clientHeight * scale));
  if (width === canvas.width && height === canvas.height) return;
  // Setting the size clears the canvas, so it is drawn again at once.
  canvas.width = width;
  canvas.height = height;
  if (!renderer || lost || !drawn) return redraw();
  cancelAnimationFrame(frame);
  draw();
}

/**
 * Interface for tests and for pages that frame this one from the same origin: the state, changes to
 * it, and the complete picture as a data: URL.
 */
window.vog = {
  state, change, move, page, source, link: linkNow,
  settled: () => new Promise((resolve) => { waiting.push(resolve); redraw(); }),
  picture: async () => { await window.vog.settled(); return picture(); },
  bits: () => renderer?.format.bits, decodes: () => decoder.done, draws: () => renderer.draws,
  ray: (pixel) => rayOf(state.camera, pixel, canvas.width, canvas.height),
};

const lightSystem = window.matchMedia('(prefers-color-scheme: light)');
/** Follows the system's light or dark scheme if the page does not set its background. */
function followSystem() {
  if (!page.systemBackground) return;
  page.background = lightSystem.matches ? [1, 1, 1, 1] : [0, 0, 0, 1];
  document.documentElement.dataset.ground = lightSystem.matches ? 'light' : 'dark';
  change({});
}
lightSystem.addEventListener('change', followSystem);

state.camera = firstView();
follow(location.hash);
followSystem();
find('open').href = location.href.replace(/#.*$/, '');
if (location.protocol === 'about:') find('open').hidden = true;  // a page inside of another has no address
startRenderer();
new ResizeObserver(fitCanvas).observe(canvas);
fitCanvas();
load().catch((error) => giveUp(`The page cannot be read: ${error.message}.`));
