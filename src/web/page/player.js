// player.js: play bar for models that are steps in time.
const find = (id) => document.getElementById(id);

export class Player {
  /**
   * count   steps
   * change  called with {model}; ready(n): whether step n can be shown at once
   */
  constructor(count, change, ready) {
    [this.count, this.change, this.ready, this.step, this.timer] = [count, change, ready, 0, 0];
    find('player').hidden = count < 2;
    find('time').max = count - 1;
    find('time').addEventListener('input', () => this.go(find('time').valueAsNumber));
    find('play').addEventListener('click', () => this.toggle());
    find('back').addEventListener('click', () => this.go(this.step - 1));
    find('next').addEventListener('click', () => this.go(this.step + 1));
  }

  get playing() { return this.timer !== 0; }

  show(step, name) {
    this.step = step;
    find('time').value = step;
    find('time').setAttribute('aria-valuetext', name);
    find('step-name').textContent = name;
    find('play').textContent = this.playing ? 'Pause' : 'Play';
    find('play').setAttribute('aria-pressed', this.playing);
  }

  /** Shows a step; the ends are joined. */
  go(step) { this.change({ model: ((step % this.count) + this.count) % this.count }); }

  toggle() {
    if (this.playing) clearTimeout(this.timer);
    this.timer = this.playing ? 0 : setTimeout(() => this.advance(), 0);
    this.change({});
  }

  /** The next step, once it can be shown. */
  advance() {
    const wait = 1000 / Number(find('speed').value), next = this.step + 1;
    if (next >= this.count && !find('loop').checked) {
      this.timer = 0;
      return this.change({});
    }
    if (this.ready(next % this.count)) this.go(next);
    this.timer = setTimeout(() => this.advance(), wait);
  }
}
