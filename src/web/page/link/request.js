// request.js: the page's state as a request of a picture (vog/request_schema.h), and requests as changes of the state. `vog render --request`
// draws the same picture.
import { isUsable } from '../camera.js';
import { mostOwnPlanes } from '../picture/clip.js';
import { reversed, walker } from '../picture/colors.js';
import { fixedLights } from '../picture/light.js';
import { mostOpacity, overRange, transferWord } from '../picture/transfer.js';
import { automaticRange, comparable, fieldKey, shownOf, shows } from '../quantity.js';
import { length, sub } from '../vectors.js';

/** Members of renderers and of files of pictures, which a page has not. */
const ofFiles = ['size', 'slabs', 'precision', 'renderer', 'pixel_error', 'kappa', 'aabb_sigma', 'interpolation', 'step', 'samples', 'anyhit', 'hits_per_slab',
  'stop_transmittance', 'color_bar', 'axes', 'scale_bar', 'title', 'least_column'];

/** `light: "studio"`. */
const studio = { shadows: true, occlusion: true, scattering: 3 };
const mostOctaves = 16;  // of scattering

const isObject = (value) => typeof value === 'object' && value !== null && !Array.isArray(value);
const areNumbers = (value, count) => Array.isArray(value) && value.length === count && value.every(Number.isFinite);
const areShares = (values) => values.every((v) => v >= 0 && v <= 1);
const isAbove = (value) => Number.isFinite(value) && value > 0;
const isDirection = (value) => areNumbers(value, 3) && length(value) > 0;
const mostLights = 8, lightWords = 'head, x,y,z or camera:x,y,z, with or without a strength as in head=0.5, or a list';

/** A light of a request: [1, 2, 1], "head=0.5", "camera:0,1,1=0.4". */
function readLight(value) {
  const [to, strength = '1', ...more] = String(value).split('='), ofCamera = to.startsWith('camera:'), numbers = (text) => text.split(',').map((part) => (part.trim() ? Number(part) : NaN));
  const towards = to === 'head' ? [0, 0, 0] : numbers(ofCamera ? to.slice(7) : to), [factor] = numbers(strength);
  return more.length === 0 && factor >= 0 && factor < Infinity && (to === 'head' || isDirection(towards)) ? { towards, ofCamera, strength: factor } : null;
}
/** A light, or a list of lights; null: some are none. */
function readLights(value) {
  const lights = (Array.isArray(value) && !value.every(Number.isFinite) ? value : [value]).map(readLight);
  return lights.length <= mostLights && lights.every(Boolean) ? lights : null;
}
/** Value of a request for these lights. */
function writeLights(lights) {
  const words = lights.map(({ towards, ofCamera, strength }) => {
    const isHead = length(towards) === 0;
    if (!ofCamera && strength === 1) return isHead ? 'head' : towards;
    return `${isHead ? 'head' : `${ofCamera ? 'camera:' : ''}${towards}`}${strength === 1 ? '' : `=${strength}`}`;
  });
  return words.length === 1 ? words[0] : words;
}
/** Points [[value, share, ...], ...] in order of their values. */
const arePoints = (all, count) => Array.isArray(all) && all.length > 0 &&
  all.every((p, n) => areNumbers(p, count) && areShares(p.slice(1)) && (n === 0 || p[0] >= all[n - 1][0]));
/** Gradient opacity [[magnitude, factor], ...]: 2 to 8 points, ascending. */
const isGradient = (all) => arePoints(all, 2) && all.length >= 2 && all.length <= 8 && all[0][0] >= 0 && all.every(([m], n) => n === 0 || m > all[n - 1][0]);
const near = (a, b) => Math.abs(a - b) <= 1e-6 * Math.max(Math.abs(a), Math.abs(b));
const samePoints = (a, b) => a.length === b.length && a.every((p, n) => p.every((v, k) => Math.abs(v - b[n][k]) < 1e-3));

/** Vertical angle of a pinhole camera from that of the shorter side, degrees; factor -1: back. */
function vertical(fov, [width, height], factor = 1) {
  const tall = Math.max(1, height / width) ** factor;
  return tall === 1 ? fov : (360 / Math.PI) * Math.atan(tall * Math.tan((fov * Math.PI) / 360));
}
/** Width of an orthographic picture, shorter sides. */
const across = ([width, height]) => width / Math.min(width, height);

const backgrounds = { black: [0, 0, 0, 1], white: [1, 1, 1, 1], transparent: [0, 0, 0, 0] };

function sizeOf(size) {
  if (typeof size === 'string') return sizeOf(size.split('x').map(Number));
  return areNumbers(size, 2) && size.every((side) => side >= 1) ? size : [1, 1];
}

function fieldOf({ fields }, text) {
  if (typeof text !== 'string') return null;
  const whole = fields.findIndex(({ name }) => name === text);
  if (whole >= 0) return { field: whole, part: fields[whole].vector ? 'view' : '' };
  const dot = text.lastIndexOf('.'), part = text.slice(dot + 1);
  const field = fields.findIndex(({ name, vector }) => vector && name === text.slice(0, dot));
  return field >= 0 && ['x', 'y', 'z', 'magnitude'].includes(part) ? { field, part } : null;
}

const isAtValues = (tf) => isObject(tf) && areNumbers(tf.domain, 2);
const nameOf = (name) => (typeof name === 'string' && name ? name.slice(0, 60) : 'own');

/** Points of `tf` over [0, 1], where they are of shares or of values; null: none. */
function sharesOf({ name, colors, opacity: given, domain = [0, 1] }) {
  const opacity = given ?? [];
  if (!arePoints(colors, 4) || !areNumbers(domain, 2) || (opacity.length !== 0 && !arePoints(opacity, 2))) return null;
  const [low, high] = domain, over = (points) => points.map(([v, ...rest]) => [(v - low) / (high - low), ...rest]);
  return low < high ? { name: nameOf(name), colors: over(colors), opacity: over(opacity), own: true } : null;
}

/** {map, reverse} of the page's maps, to which one of unknown points is added, in place of those before but the shown one; null: `tf` is no map. */
function mapOf(page, tf, shown) {
  if (typeof tf === 'string') return page.maps.some(({ name }) => name === tf) ? { map: tf, reverse: false } : null;
  const given = isObject(tf) ? sharesOf(tf) : null;
  if (!given) return null;
  for (const map of page.maps)
    for (const reverse of [false, true])
      if (samePoints((reverse ? reversed(map) : map).colors, given.colors) && samePoints(map.opacity ?? [], given.opacity)) return { map: map.name, reverse };
  page.maps = page.maps.filter(({ name, own }) => !own || name === shown);
  while (page.maps.some(({ name }) => name === given.name)) given.name += ' (own)';
  page.maps.unshift(given);
  return { map: given.name, reverse: false };
}

const bandRows = 'rows of lower, upper or null, [r, g, b] and opacity: [[1, 2, [1, 0, 0], 0.5]]';

/** Transfer function of bands [[low, high or null, [r, g, b], opacity], ...]; null: they are none. As vog::band_transfer. */
function ofBands(bands, upper) {
  const are = Array.isArray(bands) && bands.length > 0 && bands.every((band) => Array.isArray(band) && band.length === 4 && Number.isFinite(band[0]) &&
    (band[1] === null || band[1] > band[0]) && areNumbers(band[2], 3) && areShares([...band[2], band[3]]));
  if (!are) return null;
  const all = bands.map(([low, high, color, opacity]) => [low, high ?? Math.max(low, upper), color, opacity]);
  return {
    name: 'bands', colors: all.flatMap(([low, high, color]) => [[low, ...color], [high, ...color]]),
    opacity: all.flatMap(([low, high, , opacity]) => [[low, 0], [low, opacity], [high, opacity], [high, 0]]),
  };
}

/** Unit distance of a map over a range, as vog::map_unit_distance, or of stated opacities, without a range. */
function unitOf(source, range) {
  if (!source.unitOf) return source.unitDistance;  // of earlier versions
  const [middle, thickness, rough] = source.unitOf;
  if (!range) return rough;
  const { low, high, log } = range, at = Math.min(1, Math.max(0, log ? Math.log(middle / low) / Math.log(high / low) : (middle - low) / (high - low)));
  const unit = Number((Math.max(0.1, log ? at * at : at) * thickness).toPrecision(2));
  return unit > 0 ? unit : rough;
}

/**
 * Transfer function of a volume's field that a request states; null: the page's own.
 * now     the state with the request's map
 * before  the field's, whose members stay where the request states none; null: none
 * isOther whether another map is under it
 */
function transferOf(page, request, now, before, isOther, wrong) {
  const all = comparable(page, now.model), source = all[0].fields[now.field], gradient = [request.gradient_opacity, request.tf?.gradient_opacity, before?.gradient].find(isGradient);
  const named = page.maps.find(({ name }) => name === now.map), map = now.reverse ? reversed(named) : named;
  let made = null, range = null;
  if (areNumbers(request.window, 2)) {
    const [low, high] = [-0.5, 0.5].map((side) => request.window[0] + side * request.window[1]);
    made = { name: 'window', colors: [[low, 0, 0, 0], [high, 1, 1, 1]], opacity: [[low, 0], [high, mostOpacity]] };
  } else if (request.bands?.length > 0) {
    made = ofBands(request.bands, source.upper);
    if (!made) wrong('bands', bandRows);
  } else if (isAtValues(request.tf)) {
    const { name, colors, opacity, domain } = request.tf;
    if (arePoints(colors, 4)) made = { name: nameOf(name), colors, opacity: arePoints(opacity, 2) ? opacity : [[domain[0], 0], [domain[1], 1]] };
    else wrong('tf', 'points in order');
  } else if (before && !request.range && !request.scale) {
    made = { ...before, ...(isOther && { colors: overRange(map, before.colors[0][0], before.colors.at(-1)[0], 1, false).colors }) };
  } else {
    const usual = automaticRange(all, now.field), [low, high] = request.range ?? [usual.low, usual.high];
    const log = request.scale === 'log' || (!request.range && request.scale !== 'linear' && usual.log), hasOpacity = map.opacity?.length > 0;
    const isUsual = near(low, usual.low) && near(high, usual.high) && log === usual.log && near([request.unit_distance, request.tf?.unit_distance].find(isAbove) ?? usual.unit, usual.unit);
    if (isUsual && !gradient && !Number.isFinite(request.threshold) && !hasOpacity) return null;
    if (log && !(low > 0)) wrong(request.range ? 'range' : 'scale', 'values above 0 with scale log', request.range ?? request.scale);
    else made = overRange(map, low, high, 1, log);
    if (made) made.unit = 0;
    if (!hasOpacity) range = { low, high, log };
  }
  if (made && Number.isFinite(request.threshold)) {
    const [, at] = walker(made.opacity)(request.threshold);
    made.opacity = [[request.threshold, 0], [request.threshold, at], ...made.opacity.filter(([v]) => v > request.threshold)];
  }
  return made && { ...made, unit: [request.unit_distance, request.tf?.unit_distance, made.unit].find(isAbove) ?? unitOf(source, range), gradient };
}

/**
 * Members that make a transfer function or a scale. Those that were asked for hold until others replace them, in whatever order they come:
 * state.asked has them, {words, on: the quantity and the field that they have been used on, null: not yet}.
 */
const valueWords = ['tf', 'range', 'scale', 'window', 'bands', 'threshold', 'gradient_opacity', 'unit_distance'];
const replaced = {
  window: ['tf', 'range', 'scale', 'bands'], bands: ['tf', 'range', 'scale', 'window'], range: ['tf', 'window', 'bands'], tf: ['range', 'scale', 'window', 'bands'],
};

/** Members that a value of another one replaces: a map those with colours of their own. */
const replacedBy = (key, value) => (key === 'tf' && !isAtValues(value) ? ['window', 'bands'] : Object.hasOwn(replaced, key) ? replaced[key] : []);
/** Whether a line refuses a member. */
const isRefused = (key, problems) => problems.some((line) => (line.startsWith(`${key} `) && line.includes(': expected ')) || line === `unknown setting: ${key}`);

/**
 * Members asked for, before and now.
 * returns  {asked, isNew: the request has some, isFresh: some have their defaults again}
 */
function askedOf(before, request, problems) {
  const asked = { ...before }, given = valueWords.filter((key) => request[key] !== undefined);
  let isFresh = given.some((key) => request[key] === null);
  for (const key of given) {
    const value = request[key];
    if (isRefused(key, problems)) continue;
    const isDefault = value === null || value === 'auto' || value.length === 0, isOfMap = key === 'tf' && !isAtValues(value);
    if (isDefault || (isOfMap && !value.unit_distance && !value.gradient_opacity)) delete asked[key];
    else asked[key] = value;
    for (const other of isDefault ? [] : replacedBy(key, value)) {
      if (request[other] !== undefined || asked[other] === undefined) continue;
      isFresh ||= isOfMap;  // its colours would lie under those of the bands
      delete asked[other];
    }
  }
  return { asked, isNew: given.length > 0, isFresh };
}

/**
 * Request of two, one after the other, but for the members of the second that a view has refused.
 * held  members that the view has for its transfer function or scale, which another field lacks; null: no view
 */
export function joined(first, second, problems, held) {
  const all = { ...first };
  for (const [key, value] of Object.entries(second)) {
    if (value === undefined || key === 'size' || isRefused(key, problems)) continue;
    for (const other of value === null ? [] : replacedBy(key, value))
      if (second[other] === undefined && (other !== 'tf' || isAtValues(all.tf))) delete all[other];  // a map goes with any of them
    if (value === null) {
      delete all[key];
    } else if (key === 'camera' && isObject(value)) {
      // A lens replaces the other one, and is that of a picture of its size.
      const isLens = (name) => name === 'fov_degrees' || name === 'orthographic_width', hasLens = Object.keys(value).some(isLens);
      all.camera = { ...Object.fromEntries(Object.entries(all.camera ?? {}).filter(([name]) => !hasLens || !isLens(name))), ...value };
      if (hasLens) all.size = second.size;
    } else {
      all[key] = value;
    }
  }
  for (const key of held ? valueWords : []) if (held[key] === undefined && (key !== 'tf' || isAtValues(all.tf))) delete all[key];
  return all;
}

/**
 * Change of the state by the members of a request; others stay, and null stands for a member's default.
 * home     the view of a page that opens
 * returns  {part, background: a color, 'system', or 'first' as in the first view; null: stays, problems: a line for each member that the page does not take}
 */
export function partOfRequest(page, state, request, home) {
  const part = {}, problems = [], model = page.models[state.model];
  let background = null;
  const wrong = (key, expected, value = request[key]) => problems.push(`${key} ${String(JSON.stringify(value)).slice(0, 60)}: expected ${expected}`);
  const taken = new Set(ofFiles);
  /** Takes a member: `read` gives a part of the state, null for another value than is expected. */
  const take = (key, expected, read, unset) => {
    taken.add(key);
    if (request[key] === undefined) return;
    const got = request[key] === null ? unset : read(request[key]);
    if (got) Object.assign(part, got);
    else wrong(key, expected);
  };

  take('show', shows(model).map(([name]) => name).join(', '), (show) => (shows(model).some(([name]) => name === show) ? { show } : null), { show: 'T' });
  take('field', model.fields.map(({ name }) => name).join(', ') || 'none', (text) => (text === '' ? { field: -1, part: '' } : fieldOf(model, text)), { field: -1, part: '' });
  const volume = (part.show ?? state.show) === 'volume', ofValues = volume && isAtValues(request.tf);
  take('tf', `one of ${page.maps.map(({ name }) => name).join(', ')}, or points`, (tf) => (ofValues ? {} : mapOf(page, tf, state.map)), { map: page.map, reverse: false });
  take('extinction', 'auto or a number above 0', (value) => (value === 'auto' ? { exposure: 1 } : isAbove(value) ? { exposure: value / model.extinction } : null), { exposure: 1 });
  take('blend', 'true or false', (fade) => (typeof fade === 'boolean' ? { fade } : null), { fade: false });
  const lit = (more) => ({ light: { ...state.light, ...part.light, ...more } }), flag = (key, value) => (typeof value === 'boolean' ? lit({ [key]: value }) : null);
  take('light', `studio, ${lightWords}`, (to) => {
    const isStudio = to === 'studio', lights = isStudio || to === 'head' ? [] : readLights(to);
    return lights && lit({ ...(isStudio && studio), on: !isStudio, lights });
  }, lit({ on: false }));
  take('light_weights', 'four numbers', (weights) => (areNumbers(weights, 4) ? lit({ weights }) : null), lit({ weights: page.picture.light_weights }));
  const unlit = (less) => (request.light === 'studio' ? {} : lit(less));
  take('shadows', 'true or false', (on) => flag('shadows', on), unlit({ shadows: false }));
  take('ambient_occlusion', 'true or false', (on) => flag('occlusion', on), unlit({ occlusion: false }));
  take('scattering', `1 to ${mostOctaves}`, (n) => (Number.isInteger(n) && n >= 1 && n <= mostOctaves ? lit({ scattering: n }) : null), unlit({ scattering: 1 }));
  take('asymmetry', '-0.99 to 0.99', (g) => (Math.abs(g) < 1 ? lit({ asymmetry: g }) : null), unlit({ asymmetry: 0 }));
  take('clip_lights', 'true or false', (on) => ([true, false, 1, 0].includes(on) ? lit({ clipped: Boolean(on) }) : null), lit({ clipped: true }));
  const { on } = part.light ?? state.light, own = (lights) => lights && (on ? {} : lit({ lights }));
  take('light_from', lightWords, (to) => own(readLights(to)), own([]));
  if (on && request.light_from) problems.push('light_from has no effect beside light, which has a direction');
  else if (!(part.light ?? state.light).shadows)
    for (const key of ['light_from', 'scattering', 'asymmetry']) if (request[key] && request[key] !== 1) problems.push(`${key} has no effect without shadows`);
  take('clip', 'x0,y0,z0,x1,y1,z1, the lower corner first', (clip) => {
    const c = Array.isArray(clip) ? clip.flat() : null;
    return areNumbers(c, 6) && [0, 1, 2].every((k) => c[k] < c[k + 3]) ? { clip: { lower: c.slice(0, 3), upper: c.slice(3) } } : null;
  }, { clip: null });
  take('clip_planes', `at most ${mostOwnPlanes} planes nx,ny,nz,d with a normal other than 0`, (rows) => {
    const all = areNumbers(rows, 4) ? [rows] : rows;
    const are = Array.isArray(all) && all.length <= mostOwnPlanes && all.every((row) => areNumbers(row, 4) && isDirection(row.slice(0, 3)));
    return are ? { planes: all.map((row) => ({ normal: row.slice(0, 3), offset: row[3], on: true })) } : null;
  }, { planes: [] });
  take('camera', 'eye, look_at, up, and fov_degrees in (0, 180) or orthographic_width above 0', (given) => {
    if (!isObject(given)) return null;
    const size = sizeOf(request.size), { eye, look_at: at, up, fov_degrees: fov, orthographic_width: width, ...others } = given;
    const camera = { ...(state.camera ?? home), ...Object.fromEntries(Object.entries({ eye, at, up }).filter(([, v]) => v !== undefined)) };
    if (fov !== undefined) Object.assign(camera, { fov: vertical(fov, size, -1), span: 0 });
    if (width !== undefined) camera.span = width / across(size);
    const vectors = [camera.eye, camera.at, camera.up].every((v) => areNumbers(v, 3));
    const lens = [camera.fov, camera.span ?? 0].every(Number.isFinite) && width !== 0;
    return vectors && lens && Object.keys(others).length === 0 && isUsable(camera) ? { camera } : null;
  }, { camera: home });
  take('background', 'black, white, transparent, system or r,g,b', (color) => {
    const c = typeof color === 'string' ? backgrounds[color] : color;
    if (color !== 'system' && (!Array.isArray(c) || (c.length !== 3 && c.length !== 4) || !areNumbers(c, c.length) || !areShares(c))) return null;
    background = c ? [...c, 1].slice(0, 4) : color;
    return {};
  }, {});
  if (request.background === null) background = 'first';
  take('range', 'two numbers, the first below the second', (range) => (areNumbers(range, 2) && range[0] < range[1] ? {} : null), {});
  take('scale', 'auto, linear or log', (scale) => (['auto', 'linear', 'log'].includes(scale) ? {} : null), {});
  take('window', 'centre and a width above 0', (window) => (areNumbers(window, 2) && window[1] > 0 ? {} : null), {});
  take('bands', bandRows, (bands) => (Array.isArray(bands) ? {} : null), {});
  take('threshold', 'a number', (value) => (Number.isFinite(value) ? {} : null), {});
  take('gradient_opacity', 'pairs of ascending magnitudes and factors from 0 to 1', (points) => (isGradient(points) ? {} : null), {});
  take('unit_distance', 'a length above 0', (value) => (isAbove(value) ? {} : null), {});
  const { light } = part, view = part.camera ?? state.camera;
  // The light of the first view: it does not turn with the camera.
  if (light?.shadows && !light.on && view) light.lights = fixedLights(light, view);
  for (const key of Object.keys(request)) if (!taken.has(key) && request[key] !== null) problems.push(`unknown setting: ${key}`);

  const now = { ...state, ...part, ...shownOf(model, { ...state, ...part }) }, key = `${now.show} ${now.field}`, isElsewhere = state.asked.on !== null && state.asked.on !== key;
  const { asked, isNew, isFresh } = askedOf(isElsewhere ? {} : state.asked.words, request, problems);
  const isMoved = Object.keys(asked).length > 0 && ['show', 'field'].some((key) => request[key] !== undefined);
  part.asked = { words: asked, on: now.show === 'T' ? null : key };
  if (part.field >= 0 && now.field !== part.field) wrong('field', `a scalar for ${now.show}`);
  if (volume && now.show === 'volume' && (isNew || isMoved)) {
    const { [now.field]: before, ...others } = state.transfers, { length: said } = problems, isMapAlone = !isFresh && Object.keys(asked).length === 0;
    const transfer = isMapAlone ? before : transferOf(page, asked, now, isFresh ? null : before, request.tf !== undefined, wrong);
    // Another map is put under an edited function by the page (recolor).
    if (transfer !== before && problems.length === said) part.transfers = transfer ? { ...others, [now.field]: transfer } : others;
  } else if (!volume && (isMoved || request.range !== undefined || request.scale !== undefined)) {
    const { range, scale } = asked, log = scale === 'log';
    if (range && (!log || range[0] > 0)) part.scale = { low: range[0], high: range[1], log };
    else if (!range) part.scale = log || scale === 'linear' ? { log } : null;
    else wrong('range', 'values above 0 with scale log', range);
  }
  return { part, background, problems };
}

const fieldName = ({ fields }, { field, part }) => fields[field].name + (['', 'view'].includes(part) ? '' : `.${part}`);

/** Members of a request for the light of volumes. */
function litAs(page, { light, clip, planes }) {
  const { on, lights, weights, shadows, occlusion, scattering, asymmetry, clipped } = light, word = writeLights(lights), request = { light: on ? (lights.length > 0 ? word : 'head') : null };
  if (on || shadows || occlusion) request.light_weights = weights;
  if (shadows || page.picture.shadows) request.shadows = shadows;
  if (shadows) Object.assign(request, { scattering, asymmetry, ...(!on && lights.length > 0 && { light_from: word }) });
  if ((shadows || occlusion) && !clipped && (clip || planes.some((plane) => plane.on))) request.clip_lights = false;
  if (occlusion || page.picture.ambient_occlusion) request.ambient_occlusion = occlusion;
  return request;
}

/** Values of the members of a request, of those as well that the shown quantity has no use for. */
export function valuesOf(page, state, shown) {
  const model = page.models[state.model], background = page.systemBackground ? 'system' : page.background, edited = state.show === 'volume' && state.transfers[state.field];
  return {
    extinction: model.extinction * state.exposure, blend: state.fade, ...(state.field >= 0 && { field: fieldName(model, state) }), light_weights: state.light.weights,
    ...litAs(page, state), ...(edited && { unit_distance: edited.unit }), ...state.asked.words, ...requestOf(page, state, shown), background,
  };
}

/**
 * Request of the shown picture.
 * shown  {scale, size: [width, height] of the picture, background}
 */
export function requestOf(page, state, { scale, size, background }) {
  const model = page.models[state.model], { show } = state, volume = show === 'volume';
  const map = page.maps.find(({ name }) => name === state.map), { colors, opacity } = state.reverse ? reversed(map) : map;
  const request = { show };
  if (fieldKey(state) !== null) request.field = fieldName(model, state);
  const edited = volume ? state.transfers[state.field] : null;
  request.tf = map.own || state.reverse ? { name: state.reverse ? `${map.name}, reversed` : map.name, colors, ...(opacity?.length && { opacity }) } : map.name;
  if (edited) {
    request.tf = transferWord(edited);
  } else if (show === 'T') {
    Object.assign(request, { extinction: model.extinction * state.exposure, blend: state.fade });
  } else {
    const { low, high, log, unit } = volume ? automaticRange(comparable(page, state.model), state.field) : scale;
    Object.assign(request, { range: [low, high], scale: log ? 'log' : 'linear', ...(volume && { unit_distance: unit }) });
  }
  if (volume) Object.assign(request, litAs(page, state));
  if (state.clip || page.picture.clip) request.clip = state.clip ? [...state.clip.lower, ...state.clip.upper] : null;
  const planes = state.planes.filter(({ on }) => on).map(({ normal, offset }) => [...normal, offset]);
  if (planes.length > 0 || page.picture.clip_planes) request.clip_planes = planes.length > 0 ? planes : null;
  if (background.some((v, k) => v !== backgrounds.black[k])) request.background = background;
  const { eye, at, up, fov, span } = state.camera;
  request.camera = { eye, look_at: at, up, ...(span ? { orthographic_width: span * across(size) } : { fov_degrees: vertical(fov, size) }) };
  request.size = size;
  return request;
}

/** Digits of an eye's coordinates: eight of its distance to the point looked at, however far the world's origin is. */
export function digitsOf({ eye, look_at: at }) {
  const farthest = Math.max(...[...eye, ...at].map(Math.abs));
  return Math.min(17, 8 + Math.max(0, Math.floor(Math.log10(farthest / length(sub(at, eye))))));
}
