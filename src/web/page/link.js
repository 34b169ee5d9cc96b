// link.js: settings in the address behind #, as in #embed&map=viridis&eye=1,2,3&at=0,0,0. The page
// never changes its own address.
import { isUsable } from './camera.js';
import { length, sub } from './vectors.js';

const vector = (text) => {
  const v = (text ?? '').split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  return v.length === 3 && v.every(Number.isFinite) ? v : null;
};
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
  const flag = (name) => (words.has(name) ? words.get(name) !== '0' : null);
  return {
    embed: flag('embed') === true,
    still: flag('still') === true,
    half: flag('half') === true,
    subframes: number(words.get('subframes'), 1, 64),
    model: number(words.get('model'), 1, 1e6),
    level: number(words.get('level'), 1, 1e6),
    map: words.get('map'),
    exposure: number(words.get('exposure'), 1 / 64, 64),
    reverse: flag('reverse'),
    fade: flag('fade'),
    camera: any && isUsable(merged) ? merged : null,
  };
}

/** Address suffix of a view, for readLink. */
export function writeLink(state) {
  const { eye, at, up, fov, span } = state.camera;
  // Eight digits of the distance, whatever the distance to the world's origin.
  const farthest = Math.max(...[...eye, ...at].map(Math.abs));
  const more = Math.max(0, Math.floor(Math.log10(farthest / length(sub(at, eye)))));
  const digits = (v, count = 8) =>
    v.map((x) => Number(x.toPrecision(Math.min(17, count)))).join(',');
  const words = [`model=${state.model + 1}`, `level=${state.level + 1}`];
  words.push(`map=${encodeURIComponent(state.map)}`);
  words.push(`exposure=${Number(state.exposure.toPrecision(4))}`);
  words.push(`reverse=${state.reverse ? 1 : 0}`, `fade=${state.fade ? 1 : 0}`);
  words.push(`eye=${digits(eye, 8 + more)}`, `at=${digits(at, 8 + more)}`);
  words.push(`up=${digits(up)}`, `fov=${digits([fov])}`);
  if (span) words.push(`span=${digits([span])}`);
  return `#${words.join('&')}`;
}
