// controls.js: panel, colour bar and notices. Stateless: show() receives the state.
import { drawColorBar, reversed } from './colors.js';
import { keyHelp } from './input.js';

const find = (id) => document.getElementById(id);
const countText = (n) => n.toLocaleString('en');

function element(name, text, attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** Factor with two significant digits: × 0.25, × 1, × 4. */
const factorText = (x) => `× ${Number(x.toPrecision(2))}`;

export class Controls {
  /**
   * change    called with the part of the state that the reader changed
   * commands  {home, save, link, help, panel}
   */
  constructor(page, change, commands) {
    this.page = page;
    page.models.forEach((model, n) => {
      const label = element('label', '');
      const radio = element('input', '', { type: 'radio', name: 'model', value: n });
      label.append(radio, element('span', model.name));
      find('models').append(label);
      radio.addEventListener('change', () => change({ model: n }));
    });
    find('model-row').hidden = page.models.length < 2;
    for (const map of page.maps) find('map').append(element('option', map.name));
    for (const [keys, effect] of keyHelp)
      find('keys').append(element('dt', keys), element('dd', effect));

    const on = (id, event, act) => find(id).addEventListener(event, act);
    on('level', 'input', () => change({ level: this.levels() - 1 - find('level').valueAsNumber }));
    on('map', 'change', () => change({ map: find('map').value }));
    on('exposure', 'input', () => change({ exposure: 2 ** find('exposure').valueAsNumber }));
    on('exposure', 'dblclick', () => change({ exposure: 1 }));
    on('reverse', 'change', () => change({ reverse: find('reverse').checked }));
    on('fade', 'change', () => change({ fade: find('fade').checked }));
    for (const name of ['home', 'save', 'link', 'help']) on(name, 'click', commands[name]);
    on('toggle', 'click', commands.panel);
    on('notice', 'click', () => say(''));
    on('description', 'click', () => find('description').classList.toggle('open'));
    on('close-help', 'click', () => find('help-box').close());
  }

  levels() { return this.page.models[this.model].levels.length; }

  show(state) {
    const { page } = this, model = page.models[state.model];
    this.model = state.model;
    find('models').querySelectorAll('input')[state.model].checked = true;
    const level = find('level'), count = model.levels[state.level].count;
    level.max = model.levels.length - 1;
    level.value = model.levels.length - 1 - state.level;  // to the right: finer
    level.disabled = model.levels.length < 2;
    const counted = `${countText(count)} ${count === 1 ? 'Gaussian' : 'Gaussians'}`;
    find('count').textContent = counted;
    level.setAttribute('aria-valuetext', counted);
    find('map').value = state.map;
    find('exposure').value = Math.log2(state.exposure);
    find('exposed').textContent = factorText(state.exposure);
    find('exposed').title = `extinction ${(model.extinction * state.exposure).toPrecision(6)}`;
    find('exposure').setAttribute('aria-valuetext', factorText(state.exposure));
    find('reverse').checked = state.reverse;
    find('fade').checked = state.fade;
    const map = page.maps.find(({ name }) => name === state.map);
    drawColorBar(find('bar'), state.reverse ? reversed(map) : map,
                 { fade: state.fade, background: page.background });
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
