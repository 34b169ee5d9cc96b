// loading.js: from files on a server to chunks on the GPU: which ones a cut lacks, decoding, and those that cannot be had.
import { instanceFloats } from '../model/gaussians.js';
import { Damaged } from '../model/columns.js';
import { Refused, tableOf } from './rows.js';

const mostDecoding = 3;  // in the worker's line: enough that it never waits

export class Loading {
  /**
   * store  of store.js
   * source  of source.js or range_file.js
   * hooks  {renderer(): null: none, changed(): something has come or cannot be had; lacks(chunk, field, line): why not}
   */
  constructor(page, source, decoder, store, hooks) { Object.assign(this, { page, source, decoder, store, hooks, decoding: 0 }); }

  /** Whether a chunk cannot be had with a field; null: none. */
  isBad({ bad, badFields }, field) { return bad === true || badFields?.has(field) === true; }

  /** Marks a chunk, or one of its fields, as one that cannot be had. */
  refuse(chunk, field, line) {
    if (field === null) chunk.bad = true;
    else (chunk.badFields ??= new Set()).add(field);
    this.hooks.lacks(chunk, field, line);
  }

  /**
   * Files that a cut lacks, as Requests takes them, the most useful first; decodes what has come.
   * n      place of the model
   * field  place of the shown field; null: none
   */
  files(tree, n, { chunks, tables }, field) {
    const list = [], { source } = this;
    const add = (use, file, take, failed, again = false) => list.push({
      use, ...file, done: take, cache: again ? 'reload' : undefined,
      failed: (kind, reason) => { failed(`${file.name}: ${reason}`); this.hooks.changed(); },
    });
    for (const { chunk, use } of tables)
      add(use, source.table(chunk), (body) => this.takeTable(tree, chunk, body), (line) => this.refuseTable(chunk, line), chunk.tableAgain);
    for (const { chunk, use } of chunks) {
      if (this.isBad(chunk, field)) continue;
      const kept = this.store.of(chunk);
      const take = (set) => (body) => {
        set(this.store.of(chunk), body);
        this.decode(chunk, n, field);
        this.hooks.changed();
      };
      if (!kept.shapes)
        add(use, source.shapes(chunk), take((to, body) => { to.shapes = body; }), (line) => this.refuse(chunk, null, line), chunk.again?.has(null));
      if (field !== null && !kept.fields.has(field))
        add(use, source.field(chunk, field), take((to, body) => to.fields.set(field, body)), (line) => this.refuse(chunk, field, line),
            chunk.again?.has(field));
      this.decode(chunk, n, field);
    }
    return list.sort((a, b) => b.use - a.use);
  }

  refuseTable(chunk, line) {
    chunk.tableBad = true;
    this.hooks.lacks(chunk, null, line);
  }

  takeTable(tree, chunk, body) {
    try {
      chunk.parts = tableOf(body, tree, chunk);
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      if (chunk.tableAgain) this.refuseTable(chunk, error.message);
      chunk.tableAgain = true;  // past all caches
    }
    this.hooks.changed();
  }

  /** Decodes what has come of a chunk and is not on the GPU. */
  decode(chunk, n, field) {
    const { kept } = chunk, { center, unit, extinction, cutoff, fields } = this.page.models[n];
    if (kept.shapes && !kept.gpu)
      this.once(chunk, null, ['decodeLevel', this.source.shapesOf(chunk, kept.shapes), { center, unit }, extinction], (instances, renderer) => {
        if (instances.length !== chunk.gaussians * instanceFloats) throw new Damaged();
        kept.gpu = renderer.upload(instances, cutoff);
        if (!chunk.parent) kept.coarse ??= { instances, fields: new Map() };
        this.decode(chunk, n, field);
      });
    if (field === null || !kept.gpu || !kept.fields.has(field) || kept.gpu.fields.has(field)) return;
    const { vector, reference, scale } = fields[field];
    this.once(chunk, field, this.source.fieldCall(chunk, kept, field, { vector, reference, scale }), (data, renderer) => {
      if (!kept.gpu) return;
      renderer.uploadField(kept.gpu, field, data, vector);
      if (!vector) kept.coarse?.fields.set(field, data);
    });
  }

  /**
   * Decodes something of a chunk, unless that is under way, or enough else: the next plan decodes what is the most useful then.
   * take  receives the result and the renderer, if there still is one
   */
  async once(chunk, field, call, take) {
    const { kept } = chunk;
    if (kept.busy.has(field) || this.decoding >= mostDecoding) return;
    ++this.decoding;
    kept.busy.add(field);
    const out = await this.decoder.decoded(...call).catch((error) => error), renderer = this.hooks.renderer();
    --this.decoding;
    kept.busy.delete(field);
    try {
      if (out instanceof Error) throw out;
      if (renderer) take(out, renderer);
    } catch (error) {
      this.spoiled(chunk, field, error.message === new Damaged().message ? 'damaged' : error.message);
    }
    this.hooks.changed();
  }

  /** A file that cannot be decoded: asked for once more, past all caches, then refused. */
  spoiled(chunk, field, reason) {
    if (chunk.again?.has(field)) return this.refuse(chunk, field, `${(field === null ? this.source.shapes(chunk) : this.source.field(chunk, field)).name}: ${reason}`);
    (chunk.again ??= new Set()).add(field);
    if (field === null) chunk.kept.shapes = null;
    else chunk.kept.fields.delete(field);
  }
}
