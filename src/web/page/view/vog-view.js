// vog-view.js: the element for other people's pages. The module's own lines follow `shaders` and `defaults` (view_module() of export_html.h).
import { elementOf } from './element.js';
import { answering } from '../model/worker.js';

/** The worker is this module. Bundles of other people have another name: they would run all they are. */
function worker() {
  if (!/\/vog-view\.js$/.test(new URL(import.meta.url).pathname)) throw new Error('no module of its own');
  return new Worker(import.meta.url, { type: 'module', name: 'vog-view' });
}

export const VogView = elementOf({ shaders, page: defaults, worker });
if (globalThis.customElements && !customElements.get('vog-view')) customElements.define('vog-view', VogView);
if (typeof document === 'undefined' && globalThis.name === 'vog-view') answering();
