// requests.js: files from a web server, the most useful ones first, few at a time: cancelled when nobody wants them any more, tried
// again when the connection drops.

const mostAtOnce = 6;                 // connections that browsers open to one server by HTTP/1.1
const mostTries = 5, firstPause = 300; // milliseconds before the second try, twice as long before each further one
const longPause = 20e3;               // before another round of tries

/** Why a file cannot be had: 'missing', 'damaged' or 'away', and the reason in words. */
class Failure extends Error {
  constructor(kind, message) {
    super(message);
    this.kind = kind;
  }
}

/** Bytes of a file; undefined `bytes`: any number of them. */
async function fetched({ url, bytes }, signal, cache) {
  const answer = await fetch(url, { signal, cache }).catch((error) => {
    throw signal.aborted ? error : new Failure('away', 'no connection');
  });
  const busy = answer.status >= 500 || answer.status === 429 || answer.status === 408;
  if (!answer.ok) throw new Failure(busy ? 'away' : 'missing', `HTTP ${answer.status}`);
  const body = await answer.arrayBuffer().catch((error) => {
    throw signal.aborted ? error : new Failure('away', 'the connection dropped');
  });
  return new Uint8Array(body);
}

export class Requests {
  /**
   * tell  {changed(): bytes have come; away(isAway): the server does not answer, or does again}
   */
  constructor(tell) {
    Object.assign(this, { tell, list: [], flying: new Map(), tries: new Map(), loaded: 0, timer: 0, isAway: false });
    window.addEventListener('online', () => this.again());
  }

  /**
   * Sets all files that are wanted, the most useful first; requests of others are cancelled.
   * list  [{url, bytes: undefined: any number; cache: of fetch; done(bytes), failed(kind, reason): 'missing' or 'damaged'}]
   */
  plan(list) {
    this.list = list;
    const urls = new Set(list.map(({ url }) => url));
    for (const [url, { stop }] of this.flying) if (!urls.has(url)) stop.abort();
    this.start();
  }

  /** Files that are under way or wait for it; none that the server has not answered several times. */
  get toCome() { return this.list.filter((one) => !one.gone && !this.isHeld(one.url)); }
  isHeld(url) { return (this.tries.get(url)?.count ?? 0) >= mostTries; }
  /** Whether any file has not been answered: else none is held. */
  get hasFailed() { return this.tries.size > 0; }

  /** Tries what has been given up for now. */
  again() {
    this.tries.clear();
    this.start();
  }

  start() {
    clearTimeout(this.timer);
    const now = performance.now();
    let next = Infinity;
    for (const one of this.list) {
      if (this.flying.size >= mostAtOnce) return;
      if (one.gone || this.flying.has(one.url)) continue;
      const { until } = this.tries.get(one.url) ?? { until: 0 };
      if (until <= now) this.get(one);
      else next = Math.min(next, until);
    }
    if (next < Infinity) this.timer = setTimeout(() => this.start(), next - now + 1);
  }

  async get(one) {
    const stop = new AbortController(), { url } = one, tried = this.tries.get(url)?.count ?? 0;
    this.flying.set(url, { stop });
    try {
      // A damaged file may be a cache's.
      let body = await fetched(one, stop.signal, one.cache ?? 'default');
      if (one.bytes !== undefined && body.length !== one.bytes) body = await fetched(one, stop.signal, 'reload');
      this.loaded += body.length;
      // Steps in time may share chunks: one answer is for all of them.
      const all = this.settle(one);
      if (one.bytes !== undefined && body.length !== one.bytes) throw new Failure('damaged', `${body.length} bytes, expected ${one.bytes}`);
      for (const { done } of all) done(body);
    } catch (error) {
      this.flying.delete(url);
      if (!stop.signal.aborted) this.fail(one, error, tried + 1);
    }
    this.tell.changed();
    this.start();
  }

  /** A file has come; returns all that wait for it. */
  settle(one) {
    this.flying.delete(one.url);
    this.tries.delete(one.url);
    const all = this.list.filter(({ url }) => url === one.url);
    for (const each of all) each.gone = true;
    this.setAway(false);
    return all;
  }

  fail(one, { kind = 'damaged', message }, count) {
    if (kind !== 'away') {
      one.gone = true;
      return one.failed(kind, message);
    }
    const pause = count < mostTries ? firstPause * 2 ** (count - 1) : longPause;
    this.tries.set(one.url, { count, until: performance.now() + pause });
    if (count >= mostTries || !navigator.onLine) this.setAway(true, message);
  }

  setAway(isAway, reason) {
    if (this.isAway === isAway) return;
    this.isAway = isAway;
    this.tell.away(isAway, reason);
  }
}
