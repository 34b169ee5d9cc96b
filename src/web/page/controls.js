// controls.js: panel, colour bar and notices. Stateless: show() receives the state.
import { fading, reversed, sampled } from './picture/colors.js';
import { ClipControls } from './clip_controls.js';
import { Editor, presets } from './editor.js';
import { choices, label, numberText, shows, stepOf } from './quantity.js';
import { fixedLights, withFirst } from './picture/light.js';
import { remapped, transferWord } from './picture/transfer.js';
import { length, mul } from './vectors.js';

const find = (id) => document.getElementById(id);
const towards = ['towards-0', 'towards-1', 'towards-2'];

/** Lines of the help: [keys, effect]. */
const keyHelp = [
  ['drag', 'turn'],
  ['Shift + drag, two fingers', 'move'],
  ['wheel, pinch', 'zoom to the pointer, through the volume if need be'],
  ['right drag', 'of T: zoom; else the shown values: right wider, up higher'],
  ['Ctrl + right drag, the sphere', 'turn the light'],
  ['Alt + drag, twist', 'roll'],
  ['Ctrl + drag', 'look around from where you are'],
  ['W S A D, Page Up/Down', 'fly'],
  ['arrows, Q E', 'turn by 5 degrees, roll'],
  ['1 2 3, with Shift', 'view from +x +y +z, from −x −y −z'],
  ['Home, F', 'first view, fit'],
  ['5', 'orthographic, or a pinhole'],
  ['[ ]', 'less, more detail'],
  ['− = 0', 'less, more, first exposure'],
  ['M, Shift + M', 'next, previous colours'],
  ['I, B', 'reverse the colours, fade them into the background'],
  ['V', 'next quantity'],
  ['Z, Shift + Z', 'undo, redo an edit of the opacity or the light'],
  ['N', 'next model'],
  ['Space , .', 'play, step back, next step'],
  ['P, C', 'save a PNG, copy a link to this view'],
  ['Ctrl + V', 'show the view of a copied link, or a picture of vog render'],
  ['L, H', 'hide colour bar, controls'],
  ['?', 'this list'],
];

function element(name, text, attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** Factor with two significant digits: × 0.25, × 1, × 4. */
const factorText = (x) => `× ${Number(x.toPrecision(2))}`;

/** Ticks of a scale: [[position, text], ...], 1, 2, 2.5 or 5 times a power of ten apart, or decades. */
export function ticks({ low, high, log }) {
  const out = [];
  if (log) {
    const decades = Math.log10(high / low), every = Math.max(1, Math.ceil(decades / 5));
    for (let p = Math.ceil(Math.log10(low) - 1e-9); p <= Math.log10(high) + 1e-9; p += every)
      out.push([(p - Math.log10(low)) / decades, numberText(10 ** p)]);
    if (out.length > 1) return out;
    return [low, high].map((end, at) => [at, numberText(end, high - low)]);
  }
  const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 2.5, 5, 10].find((m) => m * power >= rough) ?? 10);
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; ++n)
    out.push([(n * step - low) / (high - low), numberText(n * step, 0.1 * step, Math.max(-low, high))]);
  return out;
}

export class Controls {
  /**
   * change    called with the part of the state that the reader changed
   * commands  {home, save, link, help, panel, detail: called with a value of its slider, transfer: called with an edited transfer function, null: the first one}
   */
  constructor(page, change, commands) {
    this.page = page;
    this.change = change;
    page.models.forEach((model, n) => {
      const label = element('label', '');
      const radio = element('input', '', { type: 'radio', name: 'model', value: n });
      label.append(radio, element('span', model.name));
      find('models').append(label);
      radio.addEventListener('change', () => change({ model: n }));
    });
    find('model-row').hidden = page.models.length < 2 || page.steps;
    for (const map of page.maps) find('map').append(element('option', map.name));
    for (const [keys, effect] of keyHelp)
      find('keys').append(element('dt', keys), element('dd', effect));

    const on = (id, event, act) => find(id).addEventListener(event, act);
    on('level', 'input', () => commands.detail(find('level').valueAsNumber));
    on('map', 'change', () => change({ map: find('map').value }));
    on('exposure', 'input', () => change({ exposure: 2 ** find('exposure').valueAsNumber }));
    on('exposure', 'dblclick', () => change({ exposure: 1 }));
    on('reverse', 'change', () => change({ reverse: find('reverse').checked }));
    on('fade', 'change', () => change({ fade: find('fade').checked }));
    on('show', 'change', () => change({ show: find('show').value }));
    on('field', 'change', () => {
      const [field, part] = find('field').value.split('.');
      change({ field: Number(field), part });
    });
    for (const id of ['low', 'high']) on(id, 'change', () => this.setScale());
    // Ends of the first view follow the kind of scale; typed ones stay.
    on('log', 'change', () => {
      if (this.state.scale?.low !== undefined) this.setScale();
      else change({ scale: { log: find('log').checked } });
    });
    on('fit-scale', 'click', () => change({ scale: null }));
    this.attachTransfer(on, commands);
    this.clip = new ClipControls(change);
    for (const name of ['home', 'save', 'link', 'help']) on(name, 'click', commands[name]);
    on('toggle', 'click', commands.panel);
    on('notice', 'click', () => say(''));
    on('description', 'click', () => find('description').classList.toggle('open'));
    on('close-help', 'click', () => find('help-box').close());
  }

  attachTransfer(on, commands) {
    this.editor = new Editor(find('editor'), commands.transfer, commands.restore);
    for (const name of Object.keys(presets)) find('preset').append(element('option', name, { value: name }));
    on('density', 'input', () => {
      const { transfer } = this.editor;
      this.editor.edit({ ...transfer, unit: this.middleUnit / 10 ** (find('density').valueAsNumber / 3) }, true);
    });
    on('density', 'dblclick', () => {
      this.middleUnit = 0;
      this.editor.edit({ ...this.editor.transfer, unit: 0 });
    });
    on('gradient', 'pointerdown', () => this.editor.remember());
    on('gradient', 'input', () => {
      const { transfer: { gradient: _, ...transfer }, source } = this.editor, share = find('gradient').valueAsNumber;
      this.editor.edit(share > 0 ? { ...transfer, gradient: [[0, 0], [share * source.steepest, 1]] } : transfer, true);
    });
    on('preset', 'change', () => {
      const { transfer } = this.editor, make = presets[find('preset').value];
      if (make) this.editor.edit({ ...transfer, opacity: make(this.editor.axis.value) });
    });
    const relight = (part) => this.change({ light: { ...this.state.light, ...part } });
    for (const id of ['light', 'shadows', 'occlusion', 'clip-lights']) on(id, 'change', () => this.editor.remember());
    for (const id of ['scattering', ...towards]) on(id, 'pointerdown', () => this.editor.remember());
    on('light', 'change', () => relight({ on: find('light').checked }));
    on('clip-lights', 'change', () => relight({ clipped: find('clip-lights').checked }));
    on('occlusion', 'change', () => relight({ occlusion: find('occlusion').checked }));
    on('scattering', 'input', () => relight({ scattering: find('scattering').valueAsNumber }));
    // Shadows begin from the upper left of the view, and stay where that turns.
    on('shadows', 'change', () => relight({ shadows: find('shadows').checked, lights: fixedLights(this.state.light, this.state.camera) }));
    // Sliders and drags move the first light.
    for (const id of towards) on(id, 'input', () => relight({ lights: withFirst(this.state.light, { towards: towards.map((one) => find(one).valueAsNumber) }) }));
    on('log-axis', 'change', () => this.change({ logAxis: find('log-axis').checked }));
    on('undo', 'click', () => this.editor.undo());
    on('redo', 'click', () => this.editor.redo());
    on('fit-transfer', 'click', () => { this.editor.remember(); commands.transfer(null); });
    on('save-transfer', 'click', () => {
      const text = JSON.stringify(transferWord(this.editor.transfer), null, 1);
      const link = element('a', '', {
        href: `data:application/json,${encodeURIComponent(text)}`, download: 'transfer.json',
      });
      link.click();
    });
  }

  /** Texts of a range and their values: an end that is not typed keeps digits that are not shown. */
  showScale(scale) {
    this.ends = {};
    for (const id of ['low', 'high']) {
      this.ends[find(id).value = numberText(scale[id], stepOf(scale))] = scale[id];
      find(id).setAttribute('aria-invalid', false);
    }
  }
  setScale() {
    const [low, high] = ['low', 'high'].map((id) => find(id).value).map((text) => this.ends[text] ?? (text.trim() ? Number(text) : NaN)), log = find('log').checked;
    const wrong = !(low < high) || (log && !(low > 0));
    for (const id of ['low', 'high']) find(id).setAttribute('aria-invalid', wrong);
    if (wrong) say(log ? 'Range: two numbers above 0, the first below the second' : 'Range: two numbers, the first below the second');
    else this.change({ scale: { low, high, log } });
  }

  /** Quantity, its field, range, transfer function and clip. */
  showQuantity(state, model, { scale, transfer }) {
    this.state = state;
    const filled = (select, options) => {
      const key = JSON.stringify(options);
      if (select.dataset.options !== key)
        select.replaceChildren(...options.map(([value, text]) => element('option', text, { value })));
      select.dataset.options = key;
    };
    filled(find('show'), shows(model));
    find('show').value = state.show;
    const fields = choices(model, state.show);
    filled(find('field'), fields.map(({ field, part, name }) => [`${field}.${part}`, name]));
    find('field').value = `${state.field}.${state.part}`;
    find('field-row').hidden = fields.length === 0;
    const visibility = state.show === 'T', volume = state.show === 'volume';
    find('exposure-row').hidden = find('fade-label').hidden = !visibility;
    find('scale-row').hidden = visibility || volume;
    find('transfer-row').hidden = !volume;
    if (!visibility && !volume && document.activeElement !== find('low') && document.activeElement !== find('high')) this.showScale(scale);
    find('log').checked = scale.log;
    const { on, shadows, occlusion, scattering, clipped, lights: [light = { towards: [0, 0, 0] }, ...others] } = state.light, to = mul(1 / Math.max(1, ...light.towards.map(Math.abs)), light.towards);
    for (const [id, checked] of Object.entries({ light: on, shadows, occlusion, 'clip-lights': clipped })) find(id).checked = checked;
    find('scattering').value = find('octaves').textContent = scattering;
    find('scattering-row').hidden = !shadows;
    find('clip-lights-row').hidden = !volume || !(shadows || occlusion);
    find('towards-row').hidden = !shadows && !on;
    find('towards').textContent = length(to) > 0 ? `${light.ofCamera ? 'view ' : ''}${to.map((v) => v.toFixed(2)).join(' ')}${others.length > 0 ? ` and ${others.length} more` : ''}` : on ? 'the eye' : 'the view';
    towards.forEach((id, n) => { find(id).value = to[n]; });
    if (volume) {
      const source = model.fields[state.field];
      this.editor.show(transfer, source, state.light, state.logAxis);
      find('log-axis').disabled = !(source.lower > 0);
      find('log-axis').checked = this.editor.axis.log;
      this.middleUnit ||= transfer.unit;
      find('density').value = 3 * Math.log10(this.middleUnit / transfer.unit);
      find('unit').textContent = `unit ${numberText(transfer.unit)}`;
      const [steep] = transfer.gradient?.at(-1) ?? [0];
      find('gradient').disabled = !(source.steepest > 0);
      find('gradient').value = steep / source.steepest;
      find('steep').textContent = steep > 0 ? numberText(steep) : 'off';
      find('preset').value = '';
      drawTicks(find('editor-ticks'), ticks(this.editor.axis));
      find('undo').disabled = this.editor.past.length === 0;
      find('redo').disabled = this.editor.future.length === 0;
    } else {
      this.middleUnit = 0;
    }
    this.clip.show(state, model.box);
    find('of-visibility').hidden = !visibility;
    find('of-quantity').textContent = label(model, state);
  }

  /** Detail of the picture, {value, most, text: how many Gaussians}; to the right: finer. */
  showDetail({ value, most, text }) {
    const level = find('level');
    level.max = most;
    level.value = value;
    level.disabled = most < 1;
    find('count').textContent = text;
    level.setAttribute('aria-valuetext', text);
  }

  /** shown  {scale, transfer} of the state's quantity; detail: of showDetail */
  show(state, shown) {
    const { page } = this, model = page.models[state.model];
    find('models').querySelectorAll('input')[state.model].checked = true;
    this.showDetail(shown.detail);
    find('map').value = state.map;
    find('exposure').value = Math.log2(state.exposure);
    find('exposed').textContent = factorText(state.exposure);
    find('exposed').title = `extinction ${(model.extinction * state.exposure).toPrecision(6)}`;
    find('exposure').setAttribute('aria-valuetext', factorText(state.exposure));
    find('reverse').checked = state.reverse;
    find('fade').checked = state.fade;
    const map = page.maps.find(({ name }) => name === state.map);
    this.showQuantity(state, model, shown);
    const visibility = state.show === 'T';
    if (state.show === 'volume') {
      const { transfer } = shown, [from, to] = [transfer.colors[0][0], transfer.colors.at(-1)[0]];
      const range = to > from ? { low: from, high: to, log: false } : { low: from, high: from + 1, log: false };
      drawColorBar(find('bar'), remapped({ ...transfer, opacity: [] }, (v) => (v - range.low) / (range.high - range.low)),
                   { fade: false, background: page.background });
      drawTicks(find('ticks'), ticks(range));
    } else {
      drawColorBar(find('bar'), state.reverse ? reversed(map) : map,
                   { fade: visibility && state.fade, background: page.background });
      drawTicks(find('ticks'), ticks(visibility ? { low: 0, high: 1, log: false } : shown.scale));
    }
    document.body.classList.toggle('embed', state.embed);
    document.body.classList.toggle('bare', !state.panel);
    find('scale').hidden = !state.bar;
    find('toggle').setAttribute('aria-expanded', state.panel);
    find('toggle').textContent = state.panel ? 'Hide' : 'Controls';
  }

  help() {
    const box = find('help-box');
    if (box.open) box.close(); else box.showModal();
  }
}

/** Draws the colours of V from 0 (left) to 1 over the background. */
function drawColorBar(canvas, map, { fade, background }) {
  const width = canvas.width, values = sampled(fade ? fading(map) : map, width, 1);
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, 1);
  const [r, g, b, a] = background;
  for (let i = 0; i < width; ++i) {
    const front = values[4 * i + 3] * (fade ? i / (width - 1) : 1);
    const behind = a * (1 - front), alpha = front + behind;
    [r, g, b].forEach((back, k) => {
      const color = alpha > 0 ? (front * values[4 * i + k] + behind * back) / alpha : 0;
      image.data[4 * i + k] = Math.round(255 * color);
    });
    image.data[4 * i + 3] = Math.round(255 * alpha);
  }
  context.putImageData(image, 0, 0);
}

/** Ticks below a bar; those at its ends stay within. */
function drawTicks(place, marks) {
  place.replaceChildren(...marks.map(([at, text]) => {
    const mark = element('span', text, at < 0.06 ? { class: 'first' } : at > 0.94 ? { class: 'last' } : {});
    mark.style.left = `${100 * at}%`;
    return mark;
  }));
}

let hiding = 0;
/** Shows a notice below the picture for some seconds; 0: until the next. */
export function say(text, seconds = 4) {
  const line = find('notice');
  line.textContent = text;
  line.hidden = text === '';
  clearTimeout(hiding);
  if (seconds > 0) hiding = setTimeout(() => { line.hidden = true; }, 1000 * seconds);
}

/** Shows a message instead of the picture. */
export function giveUp(text) {
  document.body.classList.add('failed');
  find('failure-text').textContent = text;
  find('failure').hidden = false;
}
