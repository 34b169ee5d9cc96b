// rows.js: manifest and rows of the chunk tree of a site (docs/streaming.md), checked number by number: a server may send anything.
import { checksum } from '../model/vogz.js';

const format = 'vog site', version = 1;
const mostModels = 1e5, mostParts = 4096, mostDepth = 64;
const mostGaussians = 1 << 22, mostFileBytes = 1 << 26;  // of a chunk: a page has to hold it
const slack = 2e-5;                                      // of numbers, by which parts may exceed the chunk above: six digits each

/** An answer that is no part of a site; its message is one line: where, found, expected. */
export class Refused extends Error {}

export function refuse(where, found, expected) {
  const text = JSON.stringify(found);
  if (text === undefined) throw new Refused(`${where}: missing; expected ${expected}`);
  throw new Refused(`${where}: ${text.length > 60 ? `${text.slice(0, 57)}...` : text}, expected ${expected}`);
}
export const isObject = (v) => typeof v === 'object' && v !== null && !Array.isArray(v);
export const isCount = (v, most = Number.MAX_SAFE_INTEGER) => Number.isSafeInteger(v) && v >= 0 && v <= most;
export const areNumbers = (v, count) => Array.isArray(v) && v.length === count && v.every(Number.isFinite);

/** Value of a JSON text. Those of sites end in the CRC-32 of all before. */
export function parsedJson(bytes, where) {
  const [ending, crc] = /,"crc":(\d+)\}\n$/.exec(new TextDecoder().decode(bytes.subarray(-32))) ?? [];
  if (ending && checksum(bytes.subarray(0, bytes.length - ending.length)) !== Number(crc))
    throw new Refused(`${where}: damaged, expected bytes of the checksum ${crc}`);
  try {
    return JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
  } catch {
    throw new Refused(`${where}: not valid JSON; expected a site's manifest`);
  }
}

function nameOf(name, where) {
  if (typeof name !== 'string' || !/^[0-9a-f]{32}$/.test(name)) refuse(where, name, '32 hexadecimal digits');
  return name;
}

/** Box of six numbers relative to an origin: {center, half}, world units. */
function boxOf(box, parent, origin, where) {
  if (!areNumbers(box, 6) || [0, 1, 2].some((k) => box[k] > box[3 + k])) refuse(where, box, 'six numbers, lower ends first');
  if (parent) {
    const most = slack * Math.max(...parent.ends.map(Math.abs));
    if ([0, 1, 2].some((k) => parent.ends[k] - box[k] > most || box[3 + k] - parent.ends[3 + k] > most))
      refuse(where, box, `a box within that of the chunk above, ${JSON.stringify(parent.ends)}`);
  }
  const half = [0, 1, 2].map((k) => 0.5 * (box[3 + k] - box[k]));
  return { center: half.map((h, k) => origin[k] + box[k] + h), half };
}

/**
 * A chunk of a row, and those below it.
 * model   {origin, fields: number of them}
 * parent  chunk above; null: none
 * returns {name, nodes, gaussians, error, box: {center, half}, ends: of the row, bytes: of shapes and of each field, parts: [] where
 *         known, table: name of the file that has them, or null, tableBytes: null: not known, parent, depth}
 */
function chunkOf(row, model, parent, where) {
  if (!isObject(row)) refuse(where, row, 'a row');
  const name = nameOf(row.name, `${where}.name`), { nodes, gaussians, error, bytes } = row, depth = parent ? parent.depth + 1 : 0;
  if (depth > mostDepth) refuse(where, depth, `at most ${mostDepth} rows above one`);
  if (!isCount(gaussians, mostGaussians) || gaussians === 0) refuse(`${where}.gaussians`, gaussians, `1 to ${mostGaussians}`);
  if (!isCount(nodes, gaussians)) refuse(`${where}.nodes`, nodes, `0 to ${gaussians}`);
  if (!Number.isFinite(error) || error < 0 || error > (parent?.error ?? Infinity) * (1 + slack))
    refuse(`${where}.error`, error, `0 to ${parent?.error ?? 'any number'}`);
  if (!Array.isArray(bytes) || bytes.length !== 1 + model.fields || !bytes.every((one) => isCount(one, mostFileBytes)))
    refuse(`${where}.bytes`, bytes, `${1 + model.fields} numbers up to ${mostFileBytes}`);
  const box = boxOf(row.box, parent, model.origin, `${where}.box`);
  const chunk = { name, nodes, gaussians, error, bytes, parent, depth, box, ends: row.box, parts: null, table: null, tableBytes: null };
  if (nodes > 0 && row.table !== undefined) {
    chunk.table = nameOf(row.table, `${where}.table`);
    if (row.tableBytes !== undefined && !isCount(row.tableBytes, mostFileBytes)) refuse(`${where}.tableBytes`, row.tableBytes, 'a number of bytes');
    chunk.tableBytes = row.tableBytes ?? null;
  } else if (nodes > 0) {
    chunk.parts = partsOf(row.parts, model, chunk, where);
  }
  return chunk;
}

function partsOf(parts, model, parent, where) {
  if (!Array.isArray(parts) || parts.length === 0 || parts.length > mostParts) refuse(`${where}.parts`, parts, `1 to ${mostParts} rows`);
  return parts.map((row, n) => chunkOf(row, model, parent, `${where}.parts[${n}]`));
}

/** Chunks of a table, a file of further rows, below a chunk. */
export function tableOf(bytes, model, parent) {
  const where = `chunks/${parent.table}.json`, json = parsedJson(bytes, where);
  return partsOf(isObject(json) ? json.parts : json, model, parent, where);
}

export function checkFields(fields, of, where) {
  if (!Array.isArray(fields) || fields.length !== of.fields.length) refuse(where, fields, `the ${of.fields.length} fields of the page`);
  fields.forEach((field, n) => {
    const { name, vector } = of.fields[n];
    if (field?.name !== name || (field.kind === 'vector') !== vector) refuse(`${where}[${n}]`, field, `'${name}', as in the page`);
  });
}

/** Models of a manifest, and whether they are steps in time. */
export function modelsOf(bytes, where) {
  const json = parsedJson(bytes, where);
  if (!isObject(json) || json.format !== format) refuse(`${where}: format`, json?.format, `'${format}'`);
  if (json.version !== version) refuse(`${where}: version`, json.version, `${version}: take the viewer and the model from one export`);
  const { models, steps } = json;
  if (!Array.isArray(models) || models.length === 0 || models.length > mostModels) refuse(`${where}: models`, models?.length, `1 to ${mostModels}`);
  models.forEach((model, n) => { if (!isObject(model)) refuse(`${where}: models[${n}]`, model, 'a model'); });
  return { models, steps: steps === true };
}

/**
 * Models of a manifest, a tree of chunks each: [{gaussians, origin, fields: number, root: null where there are no Gaussians}].
 * page  of which the manifest is
 */
export function treesOf(bytes, where, page) {
  const { models } = modelsOf(bytes, where);
  if (models.length !== page.models.length) refuse(`${where}: models`, models.length, `the ${page.models.length} of the page`);
  return models.map((model, n) => {
    const at = `${where}: models[${n}]`;
    if (!isCount(model.gaussians)) refuse(`${at}.gaussians`, model.gaussians, 'a number of Gaussians');
    if (!areNumbers(model.origin, 3)) refuse(`${at}.origin`, model.origin, 'three numbers');
    checkFields(model.fields ?? [], page.models[n], `${at}.fields`);
    const tree = { gaussians: model.gaussians, origin: model.origin, fields: page.models[n].fields.length, root: null };
    if (model.gaussians > 0) tree.root = chunkOf(model.root, tree, null, `${at}.root`);
    return tree;
  });
}
