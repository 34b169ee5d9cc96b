// link.js: the page's state, its changes, and its links: settings in the address behind #, as in #embed&tf=viridis&camera.eye=1,2,3. A link
// has the members of a request (request.js) as words, key=value, in JSON without the outer brackets and quotes, and words of the page
// alone. The page never changes its own address.
import { carriedOver } from '../camera.js';
import { fieldKey, shownOf } from '../quantity.js';
import { digitsOf, partOfRequest, requestOf } from './request.js';

/** Errors in pixels that coarse parts of a streamed model may have, the range of the reader's choice. */
export const leastError = 0.5;
export const mostError = 32;

const nothingAsked = { words: {}, on: null };

/** State of a page that opens; panel: whether its controls are shown. */
export function firstState(page, panel) {
  const blank = {
    model: 0, level: 0, map: page.map, exposure: 1, reverse: false, fade: false,
    camera: null, embed: false, still: false, subframes: 8, panel, bar: true,
    show: 'T', field: -1, part: '',
    asked: nothingAsked,  // members of requests that make the scale and the transfer function, until a reader's own choice
    scale: null,     // null: the first view's; {log}: its logarithm, or not
    transfers: {},   // edited ones, by field
    light: { on: false, lights: [], weights: page.picture.light_weights, shadows: false, occlusion: false, scattering: 1, asymmetry: 0, clipped: true }, clip: null, planes: [],
    logAxis: false,  // of the values in the editor
    pixelError: 1, memory: null, most: null,  // of streamed models: error of coarse parts, pixels; limits, MB and Gaussians, or null
  };
  const state = { ...blank, ...partOfRequest(page, blank, page.picture, { fov: 38.58, span: 0 }).part, asked: nothingAsked };
  return { ...state, ...shownOf(page.models[0], state) };
}

/** State after a change of a part of it. */
export function changedState(page, before, part) {
  const state = { ...before, ...part }, { models } = page;
  state.model = Math.max(0, Math.min(state.model, models.length - 1));
  if (state.model !== before.model) {
    // Steps in time are seen from one place.
    if (!part.camera && !page.steps) state.camera = carriedOver(state.camera, models[before.model].box, models[state.model].box);
    if (part.level === undefined) state.level = 0;
  }
  state.level = Math.max(0, Math.min(state.level, models[state.model].levels.length - 1));
  state.pixelError = Math.max(leastError, Math.min(state.pixelError, mostError));
  if (!page.maps.some(({ name }) => name === state.map)) state.map = before.map;
  if (!part.asked && ['show', 'field', 'part', 'scale', 'transfers', 'map', 'reverse'].some((key) => part[key] !== undefined && part[key] !== before[key])) state.asked = nothingAsked;
  // A field that is chosen with its model is one of that model; another one is found by its name.
  Object.assign(state, shownOf(models[state.model], state, part.field === undefined ? models[before.model].fields[state.field]?.name : null));
  if ((fieldKey(state) !== fieldKey(before) || state.show !== before.show) && part.scale === undefined) state.scale = null;
  return state;
}

const number = (unset, range, low, high) => ({ unset, expected: `a number from ${range}`, read: (v) => (typeof v === 'number' && v >= low && v <= high ? v : undefined) });
const count = (unset, most) => ({ unset, expected: `a whole number${most < Infinity ? ` from 1 to ${most}` : ' above 0'}`, read: (v) => (Number.isInteger(v) && v >= 1 && v <= most ? v : undefined) });
// An attribute without a value may have its own name.
const flag = { unset: false, expected: 'true or false', read: (v, key) => (v === true || v === 1 || v === key ? true : v === false || v === 0 ? false : undefined) };
/** Words of the page: how they are read, undefined for a value that cannot be, and the value that stands for their default. */
const words = {
  embed: flag, still: flag, half: flag, logaxis: flag, subframes: count(8, 64), model: count(1, Infinity), level: count(1, Infinity),
  planes_off: { unset: [], expected: 'planes', read: (rows) => (Array.isArray(rows) ? rows : undefined) },  // listed, but off
  error: number(1, '0.5 to 32 pixels', leastError, mostError), memory: number(null, '1 to 100000 MB', 1, 1e5), most: count(null, 1e9),
  exposure: number(1, '1/64 to 64', 1 / 64, 64),
};
/** Value of a word of the page that nothing sets. */
export const unsetOf = (key) => words[key].unset;

/** Members of a request that have a default in every picture. */
export const pictureWords = ['show', 'field', 'tf', 'range', 'scale', 'extinction', 'blend', 'light', 'shadows', 'light_from', 'ambient_occlusion', 'scattering', 'asymmetry', 'clip_lights', 'clip',
  'clip_planes', 'camera'];

/** Members beside them, of volumes. */
export const volumeWords = ['unit_distance', 'window', 'bands', 'threshold', 'gradient_opacity'];

/** A value of JSON, without its brackets or quotes where it has none. */
function valueOf(text) {
  for (const json of [text, `[${text}]`]) {
    try { return JSON.parse(json); } catch { /* the next one */ }
  }
  return text;
}

/**
 * Settings of a link, or of a text with JSON of a request or of a record of a picture, whose absent members have their defaults.
 * returns  {settings: words of the page, request, problems}
 */
export function readLink(text) {
  const found = { settings: {}, request: {}, problems: [] };
  if (/^[^#]*?\{/.test(text)) {
    try {
      const json = text.slice(text.indexOf('{'), text.lastIndexOf('}') + 1), given = JSON.parse(json.replaceAll("'\\''", "'"));
      const request = given.picture ?? given;
      if (typeof request !== 'object') throw request;
      found.request = { ...Object.fromEntries([...pictureWords, ...volumeWords].map((key) => [key, null])), ...request };
    } catch {
      found.problems.push('the text is neither a link nor a request');
    }
    return found;
  }
  for (const [key, value] of new URLSearchParams(text.replace(/^[^#]*#/, ''))) {
    takeText(found, key, value === '' && !text.includes(`${key}=`) ? true : value);
  }
  return found;
}

/** Takes a word and the text of its value, true for none, into the answer of readLink. */
export const takeText = (found, key, text, name) => takeWord(found, key, text === '' ? null : text === true || key === 'field' ? text : valueOf(text), name);

/** Takes a word and its value, null for its default, into the answer of readLink; name: of the word in lines. */
export function takeWord(found, key, value, name = key) {
  if (key.startsWith('camera.')) found.request.camera = { ...found.request.camera, [key.slice(7)]: value };
  else if (!Object.hasOwn(words, key)) found.request[key] = value;
  else {
    const { unset, expected, read } = words[key], taken = value === null ? unset : read(value, key);
    if (taken === undefined) found.problems.push(`${name} ${String(JSON.stringify(value)).slice(0, 60)}: expected ${expected}`);
    else found.settings[key] = taken;
  }
}

/**
 * Change of the state by a link; others stay.
 * home     the view of a page that opens
 * returns  {part, background, problems}
 */
export function partOfLink(page, state, { settings, request, problems }, home) {
  const { model, level, error, half: _, logaxis, planes_off: off, ...others } = settings, part = { ...others };
  if (model <= page.models.length) part.model = model - 1;
  if (level !== undefined) part.level = level - 1;
  if (error !== undefined) part.pixelError = error;
  if (logaxis !== undefined) part.logAxis = logaxis;
  if (others.embed) part.panel = false;
  const now = part.model === undefined ? state : changedState(page, state, { model: part.model });
  const made = partOfRequest(page, now, request, home), { levels } = page.models[now.model];
  if (model > page.models.length) made.problems.push(`model ${model}: expected 1 to ${page.models.length}`);
  if (levels.length > 0 && level > levels.length) made.problems.push(`level ${level}: expected 1 to ${levels.length}`);
  if (off) {
    const { planes = [] } = partOfRequest(page, now, { clip_planes: off }, home).part;
    made.part.planes = [...(made.part.planes ?? state.planes.filter(({ on }) => on)), ...planes.map((plane) => ({ ...plane, on: false }))];
  }
  return { part: { ...part, ...made.part }, background: made.background, problems: [...problems, ...made.problems] };
}

/** A value as a word of a link: JSON, without brackets of numbers and quotes of words; numbers of eight digits at most. */
function wordOf(key, value, digits = 8) {
  const brief = (v) => (typeof v === 'number' ? Number(v.toPrecision(digits)) : v);
  const text = value === null ? '' : typeof value === 'string' ? value
    : Array.isArray(value) && value.every((v) => typeof v === 'number') ? value.map(brief).join(',') : JSON.stringify(value, (_, v) => brief(v));
  return `${key}=${encodeURIComponent(text).replaceAll('%2C', ',').replaceAll('%3A', ':')}`;
}

/**
 * Link of a view, for readLink and `vog render --request`.
 * shown  as of requestOf; streamed: whether detail is an error in pixels
 */
export function writeLink(page, state, shown) {
  const { camera, ...request } = requestOf(page, state, shown), digits = digitsOf(camera);
  const own = [`model=${state.model + 1}`, shown.streamed ? `error=${Number(state.pixelError.toPrecision(3))}` : `level=${state.level + 1}`];
  if (state.logAxis && state.show === 'volume') own.push('logaxis');
  const off = state.planes.filter(({ on }) => !on).map(({ normal, offset }) => [...normal, offset]);
  if (off.length > 0) own.push(wordOf('planes_off', off));
  const members = Object.entries(request).map(([key, value]) => wordOf(key, value));
  const view = Object.entries(camera).map(([key, value]) => wordOf(`camera.${key}`, value, key === 'eye' || key === 'look_at' ? digits : 8));
  return `#${[...own, ...members, ...view].join('&')}`;
}
