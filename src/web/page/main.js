// main.js: state of the page, scheduling of frames, loading of levels, commands.
import { mul } from './vectors.js';
import { carriedOver, filling, fitted, flown, orbited, rolled, seenFrom } from './camera.js';
import { withOtherProjection } from './camera.js';
import { decodeLevel } from './gaussians.js';
import { reversed } from './colors.js';
import { Renderer } from './renderer.js';
import { readLink, writeLink } from './link.js';
import { attachKeys, attachPointers } from './input.js';
import { Controls, giveUp, say } from './controls.js';

const find = (id) => document.getElementById(id);
const page = JSON.parse(find('page').textContent);
const sources = Object.fromEntries(
  [...document.querySelectorAll('script[data-shader]')].map((s) => [s.dataset.shader, s.textContent]));
const canvas = find('picture');
const narrow = () => window.matchMedia('(max-width: 640px), (max-height: 420px)').matches;

const state = {
  model: 0, level: 0, map: page.map, exposure: 1, reverse: false, fade: page.fade,
  camera: page.camera, embed: false, still: false, subframes: 8, panel: !narrow(), bar: true,
};

// --- Drawing. Changes of camera, model, level or size render T again; all others only shade. ---

const restMs = 200;       // time without motion after which the camera counts as at rest
const slowMs = 50;        // slower frames: coarser levels while the camera moves
const fastMs = 12;        // faster frames: finer levels again
const patienceMs = 100;   // no further sub-frames after one that took longer

let renderer = null, half = false, lost = false;
let decoded = [];              // instances of the model's levels, once decoded
let uploaded = [];             // levels in the GPU's memory
let loading = 0;               // number of the current load; levels of earlier ones are dropped
let complete = false;          // all levels are decoded
let drawn = null;              // camera, model, level and size of the current T
let moving = 0, coarser = 0;   // timer of the motion; levels coarser than the chosen one meanwhile
let frame = 0, inFlight = false, frameMs = 0;
let stale = false;             // something changed while a frame was in flight
let waiting = [];              // callbacks that wait for a settled picture

function request() {
  if (!frame && !inFlight && renderer && !lost) frame = requestAnimationFrame(draw);
}

/** Level to draw: the chosen one, a coarser one while moving, or the next coarser one decoded. */
function levelNow() {
  const last = page.models[state.model].levels.length - 1;
  let level = Math.min(state.level + (moving ? coarser : 0), last);
  while (level < last && !decoded[level]) ++level;
  return decoded[level] ? level : -1;
}

function draw() {
  frame = 0;
  if (lost) return;
  const { width, height } = canvas;
  const level = levelNow();
  const now = [state.camera, state.model, level, width, height];
  if (!drawn || now.some((part, n) => part !== drawn[n])) renderer.restart();
  drawn = now;
  renderer.resize(width, height);
  if (level >= 0 && !uploaded[level]) uploaded[level] = renderer.upload(decoded[level]);
  if (renderer.subframes === 0 || wantsMore())
    renderer.addDepth(uploaded[level], page.models[state.model], state.camera);
  renderer.shade({ exposure: state.exposure, fade: state.fade, background: page.background });
  if (inFlight) stale = true;
  else time();
}

/** Whether to add a sub-frame. The first frame's time is ignored: it may include shader compilation. */
const wantsMore = () => !moving && renderer.subframes < state.subframes &&
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
    if (moving && frameMs > slowMs) ++coarser;
    if (moving && frameMs < fastMs) coarser = Math.max(0, coarser - 1);
    coarser = Math.min(coarser, page.models[state.model].levels.length - 1 - state.level);
    afterFrame();
  };
  setTimeout(poll, 0);
}

function afterFrame() {
  if (stale || wantsMore()) {
    stale = false;
    return request();
  }
  if (moving || !complete) return;
  document.documentElement.dataset.drawn = page.models[state.model].levels[levelNow()].count;
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
  uploaded = [];
  drawn = null;
  setMap();
  if (renderer.format.bits === 16)
    say('32-bit float blending is missing on this device: sums are kept in 16-bit floats, and ' +
        'faint parts may show steps.', 12);
}

function setMap() {
  const map = page.maps.find(({ name }) => name === state.map);
  renderer?.setMap(state.reverse ? reversed(map) : map);
}

/** Decodes the model's levels, coarsest first, and draws each when decoded. */
async function load() {
  const turn = ++loading, index = state.model, model = page.models[index];
  if (turn > 1) say('');
  for (const level of uploaded) if (level) renderer?.release(level);
  [decoded, uploaded, complete] = [[], [], false];
  for (let level = model.levels.length - 1; level >= 0; --level) {
    const instances = await decodeLevel(
      find(`model-${index}-${level}`).textContent, model.levels[level], model.extinction);
    if (turn !== loading) return;
    decoded[level] = instances;
    drawn = null;
    redraw();
  }
  complete = true;
  if (model.levels[0].count === 0) say('This model is empty.', 0);
  redraw();
}

// --- Changes. ---

/** Changes part of the state; the only place that does. */
function change(part) {
  const before = { ...state };
  Object.assign(state, part);
  state.model = Math.max(0, Math.min(state.model, page.models.length - 1));
  if (state.model !== before.model) {
    if (!part.camera)
      state.camera = carriedOver(state.camera, box(before.model), box(state.model));
    if (part.level === undefined) state.level = 0;
  }
  state.level = Math.max(0, Math.min(state.level, page.models[state.model].levels.length - 1));
  if (!page.maps.some(({ name }) => name === state.map)) state.map = before.map;
  if (state.map !== before.map || state.reverse !== before.reverse) setMap();
  if (renderer && state.model !== before.model)
    load().catch((error) => giveUp(`The page cannot be read: ${error.message}.`));
  controls.show(state);
  redraw();
}

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
  ? page.camera : filling(page.camera, box(0), canvas.clientWidth, canvas.clientHeight));

/** Applies the settings in the address; others stay. */
function follow() {
  const link = readLink(location.hash, firstView());
  const part = { embed: link.embed, still: link.still };
  for (const key of ['subframes', 'map', 'exposure', 'reverse', 'fade', 'camera'])
    if (link[key] !== null) part[key] = link[key];
  if (link.model !== null) part.model = Math.min(link.model, page.models.length) - 1;
  if (link.level !== null) part.level = link.level - 1;
  if (link.embed) part.panel = false;
  half = link.half;
  change(part);
}

// --- Commands. ---

function picture() {
  renderer.shade({ exposure: state.exposure, fade: state.fade, background: page.background });
  return canvas.toDataURL('image/png');
}

function save() {
  const name = page.title.replace(/[^\p{L}\p{N}]+/gu, '-').replace(/^-|-$/g, '') || 'vog';
  const link = Object.assign(document.createElement('a'), { href: picture(), download: `${name}.png` });
  link.click();
}

async function copyLink() {
  const text = location.href.replace(/#.*$/, '') + writeLink(state);
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
const expose = (factor) => () => change({
  exposure: factor ? Math.max(1 / 64, Math.min(64, state.exposure * factor)) : 1,
});
function nextMap(event) {
  const names = page.maps.map(({ name }) => name);
  const step = event.shiftKey ? names.length - 1 : 1;
  change({ map: names[(names.indexOf(state.map) + step) % names.length] });
}

const controls = new Controls(page, change, {
  home, save, link: copyLink, help: () => controls.help(),
  panel: () => change({ panel: !state.panel }),
});

attachKeys({
  w: fly(0, 0, 1), s: fly(0, 0, -1), a: fly(-1, 0, 0), d: fly(1, 0, 0),
  pageup: fly(0, 1, 0), pagedown: fly(0, -1, 0),
  arrowleft: turn(-1, 0), arrowright: turn(1, 0), arrowup: turn(0, 1), arrowdown: turn(0, -1),
  q: roll(-1), e: roll(1),
  Digit1: look(0), Digit2: look(1), Digit3: look(2),
  Digit5: () => { if (!still()) move(withOtherProjection(state.camera)); },
  home, f: () => { if (!still()) move(fitted(state.camera, box())); },
  '[': () => change({ level: state.level + 1 }), ']': () => change({ level: state.level - 1 }),
  '-': expose(1 / Math.SQRT2), '=': expose(Math.SQRT2), '+': expose(Math.SQRT2), Digit0: expose(0),
  m: nextMap, i: () => change({ reverse: !state.reverse }), b: () => change({ fade: !state.fade }),
  n: () => change({ model: (state.model + 1) % page.models.length }),
  p: save, c: copyLink, l: () => change({ bar: !state.bar }),
  h: () => change({ panel: !state.panel }), '?': () => controls.help(),
});
attachPointers(canvas, {
  camera: () => state.camera, move, still, embedded: () => state.embed,
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
window.addEventListener('hashchange', follow);

/** Sets the canvas to the screen's resolution, at most two pixels per CSS pixel. */
function fitCanvas() {
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
  state, change, page,
  settled: () => new Promise((resolve) => { waiting.push(resolve); redraw(); }),
  picture: async () => { await window.vog.settled(); return picture(); },
  bits: () => renderer?.format.bits,
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
follow();
followSystem();
find('open').href = location.href.replace(/#.*$/, '');
startRenderer();
new ResizeObserver(fitCanvas).observe(canvas);
fitCanvas();
load().catch((error) => giveUp(`The page cannot be read: ${error.message}.`));
