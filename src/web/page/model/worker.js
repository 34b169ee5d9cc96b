// worker.js: the decoder in a worker: answers {id, name, list} with {id, out} or {id, error}.
import { decodeLevel } from './gaussians.js';
import { decodeField, decodeFieldFile } from './fields.js';

export const calls = { decodeLevel, decodeField, decodeFieldFile };

/** Begins to answer. */
export function answering() {
  self.onmessage = async ({ data: { id, name, list } }) => {
    try {
      const out = await calls[name](...list);
      self.postMessage({ id, out }, [out.buffer]);
    } catch (error) {
      self.postMessage({ id, error: error.message });
    }
  };
}
