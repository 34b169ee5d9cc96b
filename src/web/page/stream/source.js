// source.js: where the models of a streamed page lie: a site's folder; RangeFile (range_file.js) has the same calls.
import { Failure } from './requests.js';
import { modelsOf, treesOf } from './rows.js';

/** Site of models by their address: a folder, or a compact file; throws Error with a line for the reader. */
export function siteOf(address) {
  const wrong = (expected) => { throw new Error(`${address.slice(0, 60)}: expected ${expected}`); };
  let url;
  try {
    url = new URL(address, document.baseURI);
  } catch {
    wrong('an address with https:, or relative to the page');
  }
  const { href, protocol, host, pathname } = url, name = pathname.split('/').at(-1), isOfPage = protocol === location.protocol && host !== '';
  if (!isOfPage && !/^(https?|file|blob):$/.test(protocol)) wrong(`an address with http: or https:, not ${protocol}`);
  if (protocol === 'blob:' || /\.vogz$/i.test(name)) return { file: href };
  if (!name.includes('.')) return { manifest: 'manifest.json', base: href };
  if (/\.json$/i.test(name)) return { manifest: name, base: new URL('.', href).href };
  throw new Error(`${name}: expected a compact file, FILE.vogz, or the folder of a site, which ends in /`);
}

/** Why a page cannot read from a source, in a line; '': it may. */
export function cannotRead({ base, server }) {
  if (base.protocol === 'file:')
    return 'Browsers read models from a web server only, not from file: addresses. Serve the folder, for example with ' +
      `${server}, and open the address that it prints`;
  const isHere = ['localhost', '127.0.0.1'].includes(base.hostname);
  return location.protocol === 'https:' && base.protocol === 'http:' && !isHere
    ? `Pages with https: cannot read a model with http: (${base.origin}): give the model an address with https:` : '';
}

/** A folder of chunks, each in files of its own. */
export class Folder {
  /** site  {manifest: name of the description, base: address of the folder; '': the page's, files(name): its bytes, or their promise; undefined: a server's} */
  constructor({ manifest, base, files }) {
    this.base = new URL(base || '.', document.baseURI);
    this.base.hash = this.base.search = '';
    if (!this.base.pathname.endsWith('/')) this.base.pathname += '/';
    Object.assign(this, { manifest, files });
    this.hint = '; expected the manifest of a site';
    this.server = 'vog serve FOLDER';
  }

  /** A file as Requests takes it, and its name. */
  file(name, bytes) { return { url: new URL(name, this.base).href, name, bytes, read: this.files && ((how) => this.given(name, how)) }; }
  async given(name, { count }) {
    const body = await this.files(name);
    if (!(body instanceof Uint8Array)) throw new Failure('missing', 'no such file');
    count(body.length);
    return body;
  }
  /** The file that describes all others; their names are of their content. */
  first() { return { ...this.file(this.manifest), cache: 'no-cache' }; }
  /** What a view begins with, beside first(). */
  beside() { return [{ ...this.file('page.json'), cache: 'no-cache', hint: '; vog page MODEL -o FOLDER/ writes it beside the models' }]; }
  /** Models of what first() has brought: {models: their descriptions, steps, about: what a view begins with, where it is there}. */
  async models(bytes) { return modelsOf(bytes, this.manifest); }
  /** Trees of chunks, one a model, of what first() has brought; throws Error with a line for the reader. */
  trees(bytes, page) { return treesOf(bytes, this.manifest, page); }

  table({ table, tableBytes }) { return this.file(`chunks/${table}.json`, tableBytes ?? undefined); }
  shapes({ name, bytes }) { return this.file(`chunks/${name}.vogz`, bytes[0]); }
  field({ name, bytes }, place) { return this.file(`chunks/${name}.${place}`, bytes[1 + place]); }

  /** What decodeLevel takes of the bytes of a chunk's shapes. */
  shapesOf(chunk, shapes) { return shapes; }
  /** Call of the decoder for a field of a chunk; kept: of store.js. */
  fieldCall(chunk, { shapes, fields }, place, page) { return ['decodeFieldFile', shapes, fields.get(place), page]; }
}
