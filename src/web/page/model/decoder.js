// decoder.js: decoding of levels, chunks and fields in a worker, so that playing steps in time does not wait for it; on the page's
// own thread where there is no worker.
import { calls } from './worker.js';

export class Decoder {
  /** made  makes the worker, or throws where none can be had */
  constructor(made) {
    [this.waiting, this.next, this.worker, this.done] = [new Map(), 0, null, { worker: 0, page: 0 }];
    try {
      this.worker = made();
      this.worker.onmessage = ({ data }) => this.answer(data);
      this.worker.onerror = (event) => {
        event.preventDefault();
        this.giveUp();
      };
    } catch {
      this.worker = null;
    }
  }

  answer({ id, out, error }) {
    const { resolve, reject } = this.waiting.get(id);
    this.waiting.delete(id);
    ++this.done.worker;
    if (error === undefined) resolve(out); else reject(new Error(error));
  }
  dispose() {
    this.waiting.clear();
    this.worker?.terminate();
  }

  /** No worker can be had: what waits for it is decoded here. */
  giveUp() {
    this.worker?.terminate();
    this.worker = null;
    for (const { name, list, resolve, reject } of this.waiting.values()) this.here(name, list).then(resolve, reject);
    this.waiting.clear();
  }
  here(name, list) {
    ++this.done.page;
    return calls[name](...list);
  }

  /** Result of decodeLevel, decodeField or decodeFieldFile. */
  decoded(name, ...list) {
    if (!this.worker) return this.here(name, list);
    return new Promise((resolve, reject) => {
      const id = this.next++;
      this.waiting.set(id, { name, list, resolve, reject });
      try {
        this.worker.postMessage({ id, name, list });
      } catch {
        this.giveUp();  // a text that is too long to be sent
      }
    });
  }
}
