// outer.js: settings to and from the page around this one, a notebook say, as messages {vog: 'settings', settings: '#tf=...'} in
// the words of link.js. The outer page asks by {vog: 'get'}.

/** The window around this one. */
export class Outer {
  /**
   * inner  the page's window
   * page   {now(): its settings, follow(settings)}
   */
  constructor(inner, page) {
    this.page = page;
    this.frame = 0;
    this.last = '';
    this.window = inner.parent === inner ? null : inner.parent;
    if (!this.window) return;
    inner.addEventListener('message', ({ source, data }) => {
      if (source !== this.window || !data || typeof data !== 'object') return;
      if (data.vog === 'settings' && typeof data.settings === 'string') page.follow(data.settings);
      if (data.vog === 'get') this.last = '';
      if (data.vog) this.tell();
    });
  }

  /** Settings that have changed go out with the next frame. */
  tell() {
    if (!this.window || this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      const settings = this.page.now();
      if (settings === this.last) return;
      this.last = settings;
      this.window.postMessage({ vog: 'settings', settings }, '*');
    });
  }
}
