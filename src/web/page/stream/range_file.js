// range_file.js: a compact file (.vogz) on a web server, read by ranges of bytes: its header, then the runs that a view needs. A server
// that answers with the whole file in place of a range is taken at its word, where the file is small.
import { Damaged } from '../model/columns.js';
import { headerOf, startOf } from '../model/vogz.js';
import { treeOf } from './file_tree.js';
import { Failure, answered, whole } from './requests.js';

// Of the first request: a header of some million Gaussians, and little of what a view may not need; of all that is before the first run.
const firstBytes = 3 << 13, mostHeader = 1 << 25;
const mostWhole = 64e6;                            // of a file that comes at once
const mostGap = 8192;                              // between two runs that one request brings: less than a request costs

const wayToWrite = ': vog pack MODEL -o FILE.vogz --hierarchy --deflate writes one that pages stream';

/** Bytes of an answer, at most as many: more are not read. */
async function bodyUpTo(answer, most, tooLong, count) {
  if (Number(answer.headers.get('Content-Length') ?? 0) > most) {
    answer.body.cancel().catch(() => {});
    throw new Failure('missing', tooLong);
  }
  const reader = answer.body.getReader(), parts = [];
  let size = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    parts.push(part.value);
    size += part.value.length;
    count(part.value.length);
    if (size <= most) continue;
    reader.cancel().catch(() => {});
    throw new Failure('missing', tooLong);
  }
  return joined(parts, size);
}

function joined(parts, size) {
  const out = new Uint8Array(size);
  parts.reduce((at, part) => (out.set(part, at), at + part.length), 0);
  return out;
}

export class RangeFile {
  /** file  address of the file, absolute or relative to the page */
  constructor(file) {
    this.base = new URL(file, document.baseURI);
    this.base.hash = '';
    this.name = this.base.pathname.split('/').at(-1) || this.base.host;
    Object.assign(this, { marks: {}, size: null, here: new Uint8Array(0), isWhole: false, isChanged: false, hint: '', server: 'python3 -m http.server' });
  }

  /** Throws where the file is another one than that of the first answer, by what can be read of the answer's head. */
  checkSame({ headers }, size) {
    const now = { tag: headers.get('ETag')?.replace(/^W\//, ''), date: headers.get('Last-Modified'), size };
    for (const key of ['tag', 'date', 'size']) {
      this.isChanged ||= Boolean(this.marks[key] && now[key] && this.marks[key] !== now[key]);
      this.marks[key] ??= now[key] ?? undefined;
    }
    if (this.isChanged) throw this.changed();
  }
  changed() { return new Failure('missing', 'the file has changed on the server, reload this page'); }

  /** Bytes begin to end of the file, fewer at its end. */
  async range(begin, end, { signal, cache, count }, isFirst = false) {
    if (this.isChanged) throw this.changed();
    if (this.isWhole || (end <= this.here.length && cache !== 'reload')) return this.here.subarray(begin, end);
    const known = cache === 'reload' || begin >= this.here.length ? 0 : this.here.length - begin;
    if (known > 0) {
      const rest = await this.range(begin + known, end, { signal, cache, count });
      return joined([this.here.subarray(begin, begin + known), rest], known + rest.length);
    }
    const answer = await answered(this.base.href, { signal, cache, headers: { Range: `bytes=${begin}-${end - 1}` } }, isFirst);
    if (answer.status !== 206) {
      this.checkSame(answer, undefined);
      const body = await whole(bodyUpTo(
        answer, mostWhole, `the server answers no ranges, and the file is larger than ${mostWhole / 1e6} MB: expected another server, ` +
        'or a folder of vog page MODEL -o FOLDER/', count), signal);
      [this.here, this.isWhole] = [body, true];
      return body.subarray(begin, end);
    }
    // Other origins may keep the field to themselves.
    const text = answer.headers.get('Content-Range'), found = /^bytes (\d+)-(\d+)\/(\d+|\*)$/.exec(text ?? ''), size = Number(found?.[3]) || undefined;
    this.checkSame(answer, size);
    if (text !== null && (Number(found?.[1]) !== begin || Number(found?.[2]) !== Math.min(end, size ?? end) - 1))
      throw new Failure('damaged', `the server sends ${text.slice(0, 60)}, expected bytes ${begin}-${end - 1}`);
    return whole(bodyUpTo(answer, end - begin, `more than the ${end - begin} bytes of the range`, count), signal);
  }

  /** The header: in one request, or two where it is long. */
  async header(how) {
    // No range of an empty file can be had.
    let bytes = await this.range(0, firstBytes, how, true).catch((error) => {
      if (error.status !== 416) throw error;
      return this.here;
    });
    const explained = (message) => new Failure('damaged', message + wayToWrite);
    let start;
    try {
      start = startOf(bytes);
    } catch (error) {
      throw explained(error instanceof Damaged ? `${bytes.length > 0 ? `${bytes.length} bytes that begin` : 'an empty file,'} no compact model` : error.message);
    }
    if (start.end > mostHeader) throw explained(`a header of ${start.end} bytes, expected at most ${mostHeader}`);
    if (start.end > bytes.length && bytes.length === firstBytes) {
      const rest = await this.range(bytes.length, start.end, how);
      bytes = joined([bytes, rest], bytes.length + rest.length);
    }
    if (start.end > bytes.length) throw new Failure('damaged', `${bytes.length} bytes, expected a header of ${start.end}`);
    if (!this.isWhole) this.here = bytes;
    return bytes;
  }

  first() { return { url: this.base.href, name: this.name, bytes: undefined, cache: 'no-cache', read: (how) => this.header(how) }; }

  beside() { return []; }

  /** Description and table of what first() has brought. */
  async described(bytes) {
    try {
      return await headerOf(startOf(bytes), bytes);
    } catch {
      throw new Error(`${this.name}: a header that is damaged`);
    }
  }
  async models(bytes) {
    const { file } = await this.described(bytes);
    return { models: [{ ...file, name: this.name.replace(/\.vogz$/i, '') }], steps: false, about: file.page ?? null };
  }

  async trees(bytes, page) {
    const header = await this.described(bytes);
    const { tree, lattice, end } = treeOf(header, startOf(bytes).end, this.name, page, wayToWrite);
    if ((this.isWhole ? this.here.length : this.marks.size ?? end) !== end)
      throw new Error(`${this.name}: is ${this.isWhole ? this.here.length : this.marks.size} bytes long; its table says ${end} (truncated?)`);
    this.lattice = lattice;
    return [tree];
  }

  /** Blobs of a chunk, one behind the other, as Requests takes them. */
  blobs(list) {
    const bytes = list.reduce((sum, blob) => sum + blob.bytes, 0), first = list[0].at;
    return {
      url: `${this.base.href}#${first}`, name: `${this.name}, bytes from ${first}`, bytes, cache: 'no-store',
      read: (how) => this.gathered(list, bytes, how),
    };
  }

  /** Blobs that lie near each other come in one range. */
  async gathered(list, bytes, how) {
    const ranges = [];
    for (const { at, bytes: size } of [...list].sort((a, b) => a.at - b.at)) {
      const last = ranges.at(-1);
      if (last && at - last.end <= mostGap) last.end = at + size;
      else ranges.push({ begin: at, end: at + size });
    }
    await Promise.all(ranges.map(async (range) => { range.body = await this.range(range.begin, range.end, how); }));
    const parts = list.map(({ at, bytes: size }) => {
      const { begin, body } = ranges.find((range) => at >= range.begin && at < range.end);
      return body.subarray(at - begin, at - begin + size);
    });
    return joined(parts, parts.reduce((sum, { length }) => sum + length, 0));
  }

  table() { throw new Error('a file has one table'); }
  shapes({ runs }) { return this.blobs(runs.map(({ shapes }) => shapes)); }
  field({ runs }, place) { return this.blobs(runs.map(({ fields }) => fields[place])); }

  shapesOf({ runs, gaussians }, shapes) {
    let at = 0;
    const chunks = runs.map(({ count, shapes: { bytes, crc } }) => ({ count, shapes: { bytes: shapes.subarray(at, at += bytes), crc }, fields: [] }));
    return { ...this.lattice, gaussians, chunks };
  }
  fieldCall(chunk, { shapes, fields }, place, page) {
    const file = this.shapesOf(chunk, shapes), packed = fields.get(place);
    let at = 0;
    chunk.runs.forEach((run, n) => {
      const { bytes, crc } = run.fields[place];
      file.chunks[n].fields[place] = { bytes: packed.subarray(at, at += bytes), crc };
    });
    return ['decodeField', file, place, page];
  }
}
