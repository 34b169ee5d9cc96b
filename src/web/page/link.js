// link.js: the page's state, its changes, and settings in the address behind #, as in #embed&map=viridis&eye=1,2,3&at=0,0,0. The page
// never changes its own address.
import { carriedOver, isUsable } from './camera.js';
import { mostOwnPlanes } from './picture/clip.js';
import { fieldKey, shownOf } from './quantity.js';
import { length, sub } from './vectors.js';

/** Errors in pixels that coarse parts of a streamed model may have, the range of the reader's choice. */
export const leastError = 0.5;
export const mostError = 32;

/** State of a page that opens; panel: whether its controls are shown. */
export function firstState(page, panel) {
  const { quantity } = page;
  const state = {
    model: 0, level: 0, map: page.map, exposure: 1, reverse: false, fade: page.fade,
    camera: page.camera, embed: false, still: false, subframes: 8, panel, bar: true,
    ...shownOf(page.models[0], { show: quantity.show, field: -1, part: quantity.part ?? '' }, quantity.field),
    scale: quantity.scale,  // null: the first view's; {log: true}: its logarithm
    transfers: {},          // edited ones, by field
    light: quantity.light, clip: quantity.clip,
    planes: quantity.planes.map((plane) => ({ ...plane, on: true })),
    logAxis: false,         // of the values in the editor
    pixelError: 1, memory: null, most: null,  // of streamed models: error of coarse parts, pixels; limits, MB and Gaussians, or null
  };
  if (quantity.transfer) state.transfers[state.field] = quantity.transfer;
  return state;
}

/** State after a change of a part of it. */
export function changedState(page, before, part) {
  const state = { ...before, ...part }, { models } = page;
  state.model = Math.max(0, Math.min(state.model, models.length - 1));
  if (state.model !== before.model) {
    if (!part.camera) state.camera = carriedOver(state.camera, models[before.model].box, models[state.model].box);
    if (part.level === undefined) state.level = 0;
  }
  state.level = Math.max(0, Math.min(state.level, models[state.model].levels.length - 1));
  state.pixelError = Math.max(leastError, Math.min(state.pixelError, mostError));
  if (!page.maps.some(({ name }) => name === state.map)) state.map = before.map;
  Object.assign(state, shownOf(models[state.model], state, models[before.model].fields[state.field]?.name));
  if ((fieldKey(state) !== fieldKey(before) || state.show !== before.show) && part.scale === undefined) state.scale = null;
  return state;
}

/** Change of the state by settings of readLink; others stay. */
export function partOfLink(page, state, link) {
  const part = {};
  for (const key of ['embed', 'still', 'subframes', 'pixelError', 'memory', 'most', 'map', 'exposure', 'reverse', 'fade', 'camera', 'show', 'part', 'scale', 'clip',
    'planes', 'logAxis'])
    if (link[key] !== null) part[key] = link[key];
  if (link.light !== null) part.light = { ...state.light, on: link.light };
  if (link.model !== null) part.model = Math.min(link.model, page.models.length) - 1;
  if (link.level !== null) part.level = link.level - 1;
  const model = page.models[part.model ?? state.model] ?? page.models.at(-1);
  const named = model.fields.findIndex(({ name }) => name === link.field);
  if (named >= 0) part.field = named;
  if (link.transfer) part.transfers = { ...state.transfers, [shownOf(model, { ...state, ...part }).field]: link.transfer };
  if (link.embed) part.panel = false;
  return part;
}

const vectors = (text, count) => {
  const v = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  return v.length === count && v.every(Number.isFinite) ? v : null;
};
const vector = (text) => vectors(text, 3);
/** Points [[value, ...]] of 2 or 4 numbers, in order of their values. */
const points = (text, count) => {
  const all = (text ?? '').split(';').map((point) => vectors(point, count));
  return all.length > 0 && all.every((p, n) => p && (n === 0 || p[0] >= all[n - 1][0])) ? all : null;
};
/** Planes of a clip, nx,ny,nz,d;... and 0 behind d for one that is off; '': none. */
function planes(text) {
  if (text === null) return null;
  const all = text.split(';').filter(Boolean).map((plane) => vectors(plane, 5) ?? vectors(`${plane},1`, 5));
  if (all.length > mostOwnPlanes || !all.every((p) => p && length(p.slice(0, 3)) > 0)) return null;
  return all.map(([x, y, z, offset, on]) => ({ normal: [x, y, z], offset, on: on !== 0 }));
}
const number = (text, low, high) => {
  const v = text === null || text.trim() === '' ? NaN : Number(text);
  return v >= low && v <= high ? v : null;
};

/**
 * Settings of an address; null for absent or invalid ones.
 * camera  default of each component of the view
 */
export function readLink(hash, camera) {
  const words = new URLSearchParams(hash.replace(/^#/, ''));
  const given = {
    eye: vector(words.get('eye')), at: vector(words.get('at')), up: vector(words.get('up')),
    fov: number(words.get('fov'), 0.001, 179),
    span: number(words.get('span'), 0, Number.MAX_VALUE),
  };
  const any = Object.values(given).some((part) => part !== null);
  const merged = { ...camera };
  for (const key of Object.keys(given)) if (given[key] !== null) merged[key] = given[key];
  const colors = points(words.get('colors'), 4), opacity = points(words.get('opacity'), 2);
  const unit = number(words.get('unit'), Number.MIN_VALUE, Number.MAX_VALUE);
  const clip = vectors(words.get('clip'), 6), range = vectors(words.get('range'), 2);
  const logarithmic = words.has('log') && words.get('log') !== '0';
  const flag = (name) => (words.has(name) ? words.get(name) !== '0' : null);
  return {
    embed: flag('embed'),
    still: flag('still'),
    half: flag('half'),
    subframes: number(words.get('subframes'), 1, 64),
    model: number(words.get('model'), 1, 1e6),
    level: number(words.get('level'), 1, 1e6),
    pixelError: number(words.get('error'), leastError, mostError),
    memory: number(words.get('memory'), 1, 1e5),
    most: number(words.get('most'), 1, 1e9),
    show: words.get('show'),
    field: words.get('field'),
    part: words.get('part'),
    scale: range && range[0] < range[1] && (!logarithmic || range[0] > 0)
      ? { low: range[0], high: range[1], log: logarithmic } : !range && logarithmic ? { log: true } : null,
    transfer: colors && opacity && unit ? { name: 'own', colors, opacity, unit } : null,
    light: flag('light'),
    logAxis: flag('logaxis'),
    clip: clip && [0, 1, 2].every((axis) => clip[axis] < clip[3 + axis])
      ? { lower: clip.slice(0, 3), upper: clip.slice(3) } : null,
    planes: planes(words.get('planes')),
    map: words.get('map'),
    exposure: number(words.get('exposure'), 1 / 64, 64),
    reverse: flag('reverse'),
    fade: flag('fade'),
    camera: any && isUsable(merged) ? merged : null,
  };
}

/**
 * Address suffix of a view, for readLink.
 * shown  {field: name, scale, transfer} of the quantity, each null where the first one holds; planes: whether to name them;
 *        streamed: whether detail is an error in pixels
 */
export function writeLink(state, shown) {
  const { eye, at, up, fov, span } = state.camera;
  // Eight digits of the distance, whatever the distance to the world's origin.
  const farthest = Math.max(...[...eye, ...at].map(Math.abs));
  const more = Math.max(0, Math.floor(Math.log10(farthest / length(sub(at, eye)))));
  const digits = (v, count = 8) =>
    v.map((x) => Number(x.toPrecision(Math.min(17, count)))).join(',');
  const words = [`model=${state.model + 1}`];
  words.push(shown.streamed ? `error=${Number(state.pixelError.toPrecision(3))}` : `level=${state.level + 1}`);
  words.push(`map=${encodeURIComponent(state.map)}`);
  words.push(`exposure=${Number(state.exposure.toPrecision(4))}`);
  words.push(`reverse=${state.reverse ? 1 : 0}`, `fade=${state.fade ? 1 : 0}`);
  words.push(`eye=${digits(eye, 8 + more)}`, `at=${digits(at, 8 + more)}`);
  words.push(`up=${digits(up)}`, `fov=${digits([fov])}`);
  const brief = (list) => list.map((point) => point.map((v) => Number(v.toPrecision(6))).join(',')).join(';');
  if (state.show !== 'T') words.push(`show=${state.show}`);
  if (shown.field) words.push(`field=${encodeURIComponent(shown.field)}`);
  if (shown.field && state.part) words.push(`part=${state.part}`);
  if (shown.scale?.low !== undefined) words.push(`range=${digits([shown.scale.low, shown.scale.high])}`);
  if (shown.scale?.log) words.push('log');
  if (shown.transfer)
    words.push(`colors=${brief(shown.transfer.colors)}`, `opacity=${brief(shown.transfer.opacity)}`,
               `unit=${digits([shown.transfer.unit])}`);
  if (state.light.on) words.push('light');
  if (state.logAxis && state.show === 'volume') words.push('logaxis');
  if (state.clip) words.push(`clip=${digits([...state.clip.lower, ...state.clip.upper])}`);
  if (shown.planes) words.push(`planes=${state.planes.map(({ normal, offset, on }) => digits([...normal, offset]) + (on ? '' : ',0')).join(';')}`);
  if (span) words.push(`span=${digits([span])}`);
  return `#${words.join('&')}`;
}
