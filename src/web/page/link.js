// link.js: settings in the address behind #, as in #embed&map=viridis&eye=1,2,3&at=0,0,0. The page
// never changes its own address.
import { isUsable } from './camera.js';
import { mostOwnPlanes } from './picture/clip.js';
import { length, sub } from './vectors.js';

/** Errors in pixels that coarse parts of a streamed model may have, the range of the reader's choice. */
export const leastError = 0.5;
export const mostError = 32;

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
    embed: flag('embed') === true,
    still: flag('still') === true,
    half: flag('half') === true,
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
      ? { low: range[0], high: range[1], log: logarithmic } : null,
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
  if (shown.scale) words.push(`range=${digits([shown.scale.low, shown.scale.high])}`);
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
