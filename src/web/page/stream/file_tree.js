// file_tree.js: tree of chunks of a compact file from its header (docs/formats.md, "Compact models"), checked number by number: a server
// may send anything.
import { kinds } from '../model/vogz.js';
import { areNumbers, checkFields, isCount, isObject, refuse } from './rows.js';

const mostBytes = 1 << 26, mostOfRun = 1 << 20, mostDepth = 64, mostParts = 4096;  // of a blob; Gaussians; depths of nodes; chunks
const slack = 2e-5;                                              // of errors, by which parts may exceed the chunk above: six digits
// Gaussians of a page's chunk, as of the chunks of a site (src/io/site/tree/chunk_tree.h).
const mostOfRoot = 8192, mostOfChunk = 16384;

/**
 * Runs of Gaussians or nodes of a table: [{isNodes, depth, count, ends: box of the supports, shapes, fields: [{at, bytes, crc}]}].
 * at      of the first blob in the file
 * returns {runs, end: of the file}
 */
function runsOf(rows, fields, at, where) {
  const runs = [];
  let run = null, next = fields, hasLinks = true;  // field that is expected; whether the run has all links that it needs
  rows.forEach(({ kind, field, depth, count, bytes, crc, box }, n) => {
    const place = `${where}: blob ${n}`, blob = { at, bytes, crc };
    if (!isCount(bytes, mostBytes)) refuse(`${place}: bytes`, bytes, `at most ${mostBytes}`);
    at += bytes;
    if (kind === kinds.gaussians || kind === kinds.nodes) {
      if (next !== fields || !hasLinks) refuse(place, kind, 'the rest of the chunk before');
      if (!isCount(count, mostOfRun) || count === 0) refuse(`${place}: count`, count, `1 to ${mostOfRun}`);
      if (depth > mostDepth) refuse(`${place}: depth`, depth, `at most ${mostDepth}`);
      if (!areNumbers(box, 6) || [0, 1, 2].some((k) => box[k] > box[3 + k])) refuse(`${place}: box`, box, 'six numbers, lower ends first');
      run = { isNodes: kind === kinds.nodes, depth, count, ends: box, shapes: blob, fields: [], below: [] };
      runs.push(run);
      [next, hasLinks] = [0, !run.isNodes];
    } else if (run && kind === kinds.links && !hasLinks) {
      hasLinks = true;
    } else if (run && kind === kinds.field && hasLinks && next < fields && field === next) {
      run.fields[next++] = blob;
    } else {
      refuse(place, [kind, field], 'blobs in the order of a chunk');
    }
  });
  if (next !== fields || !hasLinks) refuse(`${where}: blobs`, rows.length, 'whole chunks');
  return { runs, end: at };
}

/** Sets parents, errors and boxes of all below each run; returns the one without a parent. */
function rooted(runs, tree, where, hint) {
  const { parents, errors } = isObject(tree) ? tree : {};
  // A model without levels is its own coarsest level, where it is small.
  if (tree === undefined && runs.length === 1 && !runs[0].isNodes) return Object.assign(runs[0], { error: 0 });
  if (tree === undefined) refuse(`${where}: tree`, tree, `that of its levels${hint}`);
  for (const [name, list] of Object.entries({ parents, errors }))
    if (!Array.isArray(list) || list.length !== runs.length) refuse(`${where}: tree.${name}`, list?.length ?? list, `${runs.length} numbers`);
  const roots = [];
  runs.forEach((run, n) => {
    const place = `${where}: tree of chunk ${n}`, parent = parents[n], error = errors[n], above = parent === -1 ? null : runs[parent];
    if (parent === -1 && run.depth === 0) roots.push(run);
    else if (!isCount(parent, n - 1) || !above.isNodes || run.depth !== above.depth + 1) refuse(place, parent, 'nodes of the depth above');
    if (!Number.isFinite(error) || error < 0 || error > (above?.error ?? Infinity) * (1 + slack) || (!run.isNodes && error > 0))
      refuse(place, error, `an error of 0 to ${above?.error ?? 'any number'}`);
    run.error = error;
    above?.below.push(run);
  });
  if (roots.length !== 1) refuse(`${where}: tree`, roots.length, `one root${hint}`);
  for (let n = runs.length; n-- > 0;) {
    const run = runs[n];
    if (run.isNodes && (run.below.length === 0 || run.below.length > mostParts)) refuse(`${where}: tree of chunk ${n}`, run.below.length, `1 to ${mostParts} chunks below`);
    run.ends = run.below.reduce((ends, { ends: other }) => ends.map((v, k) => (k < 3 ? Math.min(v, other[k]) : Math.max(v, other[k]))), run.ends);
  }
  return roots[0];
}

const total = (runs) => runs.reduce((sum, { count }) => sum + count, 0);

/**
 * A chunk as of rows.js, of runs: `nodes`, and Gaussians that have no nodes between the chunk above and these. Nodes give way to those
 * below as long as the chunk has at most `most` Gaussians then.
 */
function chunkOf(nodes, leaves, most, parent, of) {
  const runs = [...leaves];
  while (nodes) {
    const further = nodes.below.filter(({ isNodes }) => isNodes);
    if (further.length > 1 || total(runs) + total(nodes.below) > most) break;
    runs.push(...nodes.below.filter(({ isNodes }) => !isNodes));
    nodes = further[0] ?? null;
  }
  if (nodes) runs.unshift(nodes);
  const ends = [0, 1, 2, 3, 4, 5].map((k) => (k < 3 ? Math.min : Math.max)(...runs.map((run) => run.ends[k])));
  const half = [0, 1, 2].map((k) => 0.5 * (ends[3 + k] - ends[k]));
  const bytes = [runs.map(({ shapes }) => shapes), ...of.fields.map((_, n) => runs.map(({ fields }) => fields[n]))]
    .map((blobs) => blobs.reduce((sum, blob) => sum + blob.bytes, 0));
  const chunk = {
    runs, name: `${of.where}, chunk at ${runs[0].shapes.at}`, nodes: nodes?.count ?? 0, gaussians: total(runs), error: nodes?.error ?? 0, bytes, parent,
    depth: parent ? parent.depth + 1 : 0, box: { center: half.map((h, k) => of.origin[k] + ends[k] + h), half }, ends, parts: null, table: null, tableBytes: null,
  };
  if (nodes) chunk.parts = partsOf(nodes.below, chunk, of);
  return chunk;
}

/** Chunks of the runs below a chunk's nodes: together where they are few. */
function partsOf(below, parent, of) {
  const nodes = below.filter(({ isNodes }) => isNodes), leaves = below.filter(({ isNodes }) => !isNodes);
  if (nodes.length <= 1 && total(below) <= mostOfChunk) return [chunkOf(nodes[0] ?? null, leaves, mostOfChunk, parent, of)];
  return [...nodes.map((run) => chunkOf(run, [], mostOfChunk, parent, of)), ...leaves.map((run) => chunkOf(null, [run], mostOfChunk, parent, of))];
}

/**
 * Tree of a file's chunks, as treesOf's of rows.js, whose chunks have `runs` beside.
 * header  of vogz.js's headerOf
 * at      of the first blob
 * hint    how a file with a tree is written
 * returns {tree, lattice: what the decoder needs of the header, end: size of the file}
 */
export function treeOf({ file, rows }, at, where, page, hint) {
  if (!isObject(file)) refuse(where, file, 'the description of a model');
  const { gaussians, rotated, origin, corner, edge, exponent, steps, fields } = file, { models } = page;
  if (!isCount(gaussians)) refuse(`${where}: gaussians`, gaussians, 'a number of Gaussians');
  if (typeof rotated !== 'boolean') refuse(`${where}: rotated`, rotated, 'true or false');
  for (const [name, list, count] of [['origin', origin, 3], ['corner', corner, 3], ['exponent', exponent, 2], ['steps', steps, 3]])
    if (!areNumbers(list, count)) refuse(`${where}: ${name}`, list, `${count} numbers`);
  if (!(Number.isFinite(edge) && edge > 0)) refuse(`${where}: edge`, edge, 'a length');
  checkFields(fields, models[0], `${where}: fields`);
  fields.forEach(({ reference, scale, step }, n) => {
    if (!areNumbers([reference, scale, step], 3)) refuse(`${where}: fields[${n}]`, [reference, scale, step], 'numbers of a lattice');
  });
  const { runs, end } = runsOf(rows, fields.length, at, where);
  const leaves = total(runs.filter(({ isNodes }) => !isNodes));
  if (leaves !== gaussians) refuse(`${where}: gaussians`, gaussians, `the ${leaves} of its chunks`);
  const tree = { gaussians, origin, fields: fields.length, root: null };
  if (gaussians > 0) tree.root = chunkOf(...begun(rooted(runs, file.tree, where, hint)), mostOfRoot, null, { where, fields, origin });
  return { tree, lattice: { rotated, origin, corner, edge, exponent, steps, fields }, end };
}

/** Nodes and Gaussians that the coarsest chunk begins with. */
const begun = (root) => (root.isNodes ? [root, []] : [null, [root]]);
