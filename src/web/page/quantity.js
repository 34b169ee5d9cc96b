// quantity.js: what the picture shows, its scale, its words: T, column, mean and deviation of a field, volume, maximum.
import { overRange } from './picture/transfer.js';

const numbers = { T: 0, column: 1, mean: 2, deviation: 3, volume: 4, maximum: 2 };
/** Number of shade.frag. A root mean square is the deviation about the mean 0, which field.frag makes it; a maximum the mean of sums of column 1. */
export const quantityNumber = ({ show, part }) => (part === 'magnitude' && show === 'mean' ? numbers.deviation : numbers[show]);
const names = {
  T: 'Visibility', column: 'Column density', mean: 'Mean on rays', deviation: 'Deviation on rays',
  volume: 'Volume, by value', maximum: 'Maximum on rays',
};

/** Drawn in depth slabs, of scalar fields. */
export const inSlabs = (show) => show === 'volume' || show === 'maximum';
const ofField = (show) => show === 'mean' || show === 'deviation' || inSlabs(show);

/** Quantities of a model: [[show, name], ...]. */
export function shows(model) {
  const can = (show) => !ofField(show) || model.fields.some(({ vector }) => !inSlabs(show) || !vector);
  return Object.entries(names).filter(([show]) => can(show));
}

const partName = ({ name }, part) => ({ '': name, view: `${name} along the view`, magnitude: `root mean square of ${name}` }[part] ?? `${name}.${part}`);

/** Fields and parts for a quantity: [{field, part, name}, ...]. */
export function choices(model, show) {
  if (!ofField(show)) return [];
  return model.fields.flatMap((source, field) => {
    if (!source.vector) return [{ field, part: '', name: source.name }];
    if (inSlabs(show)) return [];
    return ['view', 'x', 'y', 'z', ...(show === 'mean' ? ['magnitude'] : [])].map((part) => ({ field, part, name: partName(source, part) }));
  });
}

/**
 * The nearest of what a model has to a state's {show, field, part}.
 * field  -1: none has been chosen; of volume and maximum the density where the model has it, as of `vog render`, else the first
 */
export function shownOf(model, { show, field, part }, wantedName = null) {
  if (!shows(model).some(([name]) => name === show)) return { show: 'T', field: -1, part: '' };
  const all = choices(model, show);
  if (all.length === 0) return { show, field, part };
  const near = all.filter((c) => (wantedName ? model.fields[c.field].name === wantedName : c.field === field));
  const usual = inSlabs(show) && all.find((c) => model.fields[c.field].isMeasure);
  const chosen = near.find((c) => c.part === part) ?? near[0] ?? (usual || all[0]);
  return { show, field: chosen.field, part: chosen.part };
}

/** Key of a shown field's data; null: none. */
export const fieldKey = ({ show, field, part }) => (ofField(show) ? `${field}.${part}` : null);

/** Place of the shown field among the model's; null: none. */
export const fieldPlace = ({ show, field }) => (ofField(show) ? field : null);

/**
 * What the sums of a picture depend on, all of it: {view: list of what all quantities share, of: name of these sums among those of the view}.
 * Exposure, ranges, colours, transfer functions, unit distances, the light's direction, weights and shadows come after them.
 * parts  key of source.now(); size: pixels; slabs: their number
 */
export function sumsOf(state, parts, size, slabs) {
  const { camera, model, clip, planes, show, light } = state, hasGradients = light.on || Boolean(state.transfers?.[state.field]?.gradient);
  const of = inSlabs(show) ? [show, slabs, show === 'volume' && hasGradients] : [];
  return { view: [camera, model, ...size, clip, planes], of: [parts, fieldKey(state), ...of].join(' ') };
}

const logDecades = 4;  // as `vog render --scale log`

/**
 * The scale {low, high, log} of the first view, four decades at most; over all models where they are steps.
 * isLog  logarithmic where values are above 0; undefined: where their distribution asks for it
 */
export function automaticScale(models, { show, field, part }, isLog) {
  const ranges = models.map((model) => {
    if (show === 'column') return { linear: [0, model.mostColumn], log: [model.lowColumn, model.mostColumn], isLog: model.logColumn };
    return ofField(show) && show !== 'volume' ? model.fields[field]?.ranges[part]?.[show] : null;
  }).filter(Boolean);
  const log = (isLog ?? ranges.some((range) => range.isLog)) && ranges.every((range) => range.log), ends = ranges.map((range) => (log ? range.log : range.linear));
  const low = Math.min(...ends.map(([end]) => end)), high = Math.max(...ends.map(([, end]) => end));
  if (!(low < high)) return { low: 0, high: 1, log: false };
  return log ? { low: Math.max(low, high / 10 ** logDecades), high, log } : { low, high, log };
}

/** Models of one scale: steps in time, else the shown one. */
export const comparable = ({ steps, models }, model) => (steps ? models : [models[model]]);

/** Range under a map that a volume of a field starts with: {low, high, log, unit}. */
export function automaticRange(models, field) {
  const sources = models.map((model) => model.fields[field]).filter(Boolean);
  const low = Math.min(...sources.map((s) => s.values[0])), high = Math.max(...sources.map((s) => s.values[1]));
  return { low, high, log: sources[0].log && low > 0, unit: sources[0].unitDistance };
}

/** The transfer function that a field starts with: a map over its range. */
export function automaticTransfer(models, field, map) {
  const { low, high, log, unit } = automaticRange(models, field);
  return overRange(map, low, high, unit, log);
}

/** Digits of a number of this size that show differences of `step`: four at least. */
const digitsOf = (size, step) => (step > 0 ? Math.min(15, Math.max(4, Math.ceil(Math.log10(size / step)) + 1)) : 4);

/**
 * A number for people.
 * step  the least difference that its digits show, beyond four; 0: four
 * most  size of the largest number beside it: all have one form, with or without a power of ten
 */
export function numberText(value, step = 0, most = Math.abs(value)) {
  if (!Number.isFinite(value)) return '–';
  const digits = digitsOf(Math.abs(value), step), isPlain = most >= 1e-3 && most < 10 ** Math.max(6, digitsOf(most, step));
  return value === 0 || isPlain ? `${Number(value.toPrecision(digits))}` : value.toExponential(digits - 1).replace(/\.?0*e\+?/, 'e');
}

/** The least difference to be shown of numbers on a scale. */
export const stepOf = ({ low, high }) => 0.01 * (high - low);

/** Words beside the colour bar. */
export function label(model, { show, field, part }) {
  if (show === 'column') return 'column density';
  const source = model.fields[field], unit = source?.unit ? ` [${source.unit}]` : '';
  if (show === 'T' || !source) return '';
  const words = { deviation: 'deviation of ', maximum: 'maximum of ', mean: '' }[show] ?? '';
  return `${words}${partName(source, part)}${unit}`;
}
