// main.js: the whole page around an element <vog-view>: its controls, overlays, keys and links.
import { Levels } from './model/levels.js';
import { Site } from './stream/site.js';
import { showStream } from './stream/status.js';
import { normalized, sub } from './vectors.js';
import { readLink } from './link/link.js';
import { attachKeys } from './input.js';
import { elementOf } from './view/element.js';
import { dragLight, hasLight, motions, setTransfer } from './view/motions.js';
import { Controls, giveUp, say } from './controls.js';
import { Overlay } from './overlay.js';
import { Handles, LightHandle } from './handles.js';
import { Player } from './player.js';
import { Outer } from './link/outer.js';
import { recordIn } from './link/record.js';
import { Readout } from './readout.js';

const find = (id) => document.getElementById(id);
const page = JSON.parse(find('page').textContent);
const sources = Object.fromEntries(
  [...document.querySelectorAll('script[data-shader]')].map((s) => [s.dataset.shader, s.textContent]));
find('loading').remove();
page.textOf = (model, level) => find(`model-${model}-${level}`).textContent;
const narrow = () => window.matchMedia('(max-width: 640px), (max-height: 420px)').matches;
customElements.define('vog-view', elementOf({ shaders: sources, worker: () => new Worker(URL.createObjectURL(
  new Blob([find('worker').textContent], { type: 'text/javascript' }))) }));

let controls = null, player = null, readout = null, outer = null;
const view = find('picture').around(page, {
  Models: page.site ? Site : Levels, panel: !narrow(),
  tell: {
    say, fail: giveUp, resized: showOverlay, playing: () => player?.playing, shown: showControls,
    drawn: (count) => {
      document.documentElement.dataset.drawn = count;
      readout.renew();
    },
    took: (ms) => { find('count').title = `${Math.round(ms)} ms a frame`; },
    ground: (name) => { document.documentElement.dataset.ground = name; },
    status: (status) => {
      showStream(status);
      controls.showDetail(view.source.detail());
    },
  },
});
const { state, canvas } = view, change = (part) => view.change(part);

/** Applies settings, as in the address behind #; others stay. */
function follow(settings) {
  const problems = view.apply(readLink(settings));
  if (problems.length > 0) say(`Not in this picture: ${problems.slice(0, 3).join('; ')}${problems.length > 3 ? ' …' : ''}`, 12);
}

// --- What lies over the picture and beside it. ---

const overlay = new Overlay(find('length'), find('axes'));
const handles = new Handles(find('handles'), {
  camera: () => state.camera, box: () => view.box, clip: () => state.clip, change: (clip) => change({ clip }),
  size: () => [canvas.clientWidth, canvas.clientHeight],
  place: ({ clientX, clientY }) => { const { left, top } = canvas.getBoundingClientRect(); return [clientX - left, clientY - top]; },
});
const lightHandle = new LightHandle(find('handles'), {
  light: () => state.light, camera: () => state.camera, size: () => [canvas.clientWidth, canvas.clientHeight],
  begin: () => controls.editor.remember(), drag: (step) => dragLight(view, step),
});
canvas.addEventListener('pointerdown', (event) => { if (event.buttons & 2 && event.ctrlKey && hasLight(view)) controls.editor.remember(); });
/** Handles of the clip while its controls are open, and of the light while the panel is. */
function showHandles() {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  Object.assign(find('handles').style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
  handles.show(find('clip-row').open && state.panel && !state.embed);
  lightHandle.show(hasLight(view) && state.panel && !state.embed && !state.still);
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
  controls.show(state, { scale: view.scale, transfer: view.transfer, detail: view.source.detail() });
  player?.show(state.model, view.model.name);
  readout.show();
  outer.tell();
}

readout = new Readout(canvas, view, (lines) => {
  find('probe').hidden = lines.length === 0 || state.embed;
  find('probe').textContent = lines.join('\n');
});

// --- Commands. ---

/** Follows a link or a request that is pasted or dropped, as text or in a file of a picture. */
async function take(event) {
  const given = event.clipboardData ?? event.dataTransfer, [file] = given.files;
  if (event.target.matches?.('input, textarea') || (!file && !given.types.includes('text/plain'))) return;
  event.preventDefault();
  const text = file ? await recordIn(file) : given.getData('text/plain');
  if (/[#{]/.test(text)) follow(text);
  else say(file ? `${file.name}: holds no record of a picture` : 'Neither a link nor a request', 8);
}

const picture = () => view.snapshot().toDataURL('image/png');

async function save() {
  if (view.editing) await view.settled();
  const name = page.title.replace(/[^\p{L}\p{N}]+/gu, '-').replace(/^-|-$/g, '') || 'vog';
  const link = Object.assign(document.createElement('a'), { href: picture(), download: `${name}.png` });
  link.click();
}

async function copyLink() {
  const text = location.href.replace(/#.*$/, '') + view.link;
  try {
    await navigator.clipboard.writeText(text);
    say('Link to this view copied');
  } catch {
    window.prompt('Link to this view', text);
  }
}

const moves = motions(view);
if (page.steps) player = new Player(page.models.length, change, (model) => view.source.isReady(model));
controls = new Controls(page, change, {
  home: moves.home, save, link: copyLink, help: () => controls.help(), transfer: (transfer) => setTransfer(view, transfer),
  restore({ transfer, light }) {
    if (transfer !== view.transfer) setTransfer(view, transfer);
    change({ light });
  },
  panel: () => change({ panel: !state.panel }), detail: (value) => change(view.source.detailed(value)),
});

/** The data's vertical, y or z: that of views along the axes, and of the view now. */
function stand(view, axis) {
  const { camera, still } = view.state, upright = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
  view.page.upright = upright;
  if (still) return view.change({});
  const along = Math.abs(normalized(sub(camera.at, camera.eye))[axis]) > 0.999;
  view.move({ ...camera, up: along ? camera.up : upright });
}

find('z-up').addEventListener('change', () => stand(view, find('z-up').checked ? 2 : 1));
attachKeys(window, {
  ...moves,
  ' ': () => player?.toggle(), ',': () => player?.go(state.model - 1), '.': () => player?.go(state.model + 1),
  z: (event) => {
    if (state.show === 'volume') event.shiftKey ? controls.editor.redo() : controls.editor.undo();
  },
  v: () => {
    const all = [...find('show').options].map(({ value }) => value);
    change({ show: all[(all.indexOf(state.show) + 1) % all.length] });
  },
  p: save, c: copyLink, l: () => change({ bar: !state.bar }),
  h: () => change({ panel: !state.panel }), '?': () => controls.help(),
});
window.addEventListener('hashchange', () => follow(location.hash));
window.addEventListener('paste', take);
window.addEventListener('drop', take);
window.addEventListener('dragover', (event) => event.preventDefault());
outer = new Outer(window, { now: () => view.link, follow });

/**
 * Interface for tests and for pages that frame this one from the same origin: the state, changes to
 * it, and the complete picture as a data: URL.
 */
window.vog = {
  canvas, state, change, move: (camera) => view.move(camera), page, source: view.source, link: () => view.link,
  settled: () => view.settled(), picture: async () => { await view.settled(); return picture(); },
  bits: () => view.renderer?.format.bits, decodes: () => view.decoder.done, draws: () => view.renderer.draws,
  ray: (pixel) => view.ray(pixel),
};

follow(location.hash);
find('open').href = location.href.replace(/#.*$/, '');
if (location.protocol === 'about:') find('open').hidden = true;  // a page inside of another has no address
view.start();
