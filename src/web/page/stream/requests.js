// requests.js: files from a web server, the most useful ones first, few at a time: cancelled when nobody wants them any more, tried
// again when the connection drops.

const mostAtOnce = 6;                 // connections that browsers open to one server by HTTP/1.1
const mostTries = 5, firstPause = 300; // milliseconds before the second try, twice as long before each further one
const longPause = 20e3;               // before another round of tries

/** Why a file cannot be had: 'missing', 'damaged' or 'away', and the reason in words. */
export class Failure extends Error {
  constructor(kind, message) {
    super(message);
    this.kind = kind;
  }
}

/** Whether a server of another origin answers, and does not let this page read it. */
async function isForbidden(url) {
  if (new URL(url).origin === self.origin || !navigator.onLine) return false;
  const answers = (mode) => fetch(url, { method: 'HEAD', mode, cache: 'no-store' }).then(() => true, () => false);
  return await answers('no-cors') && !await answers('cors');
}

/**
 * Answer of a server, of a good status.
 * options  of fetch
 * isFirst  nothing of its origin has been read: another one may not let this page read it
 */
export async function answered(url, options, isFirst) {
  const answer = await fetch(url, options).catch(async (error) => {
    if (options.signal.aborted) throw error;
    if (isFirst && await isForbidden(url))
      throw new Failure('missing', `${new URL(url).host} does not allow pages from ${self.origin}: its answer needs Access-Control-Allow-Origin`);
    throw new Failure('away', 'no connection');
  });
  const busy = answer.status >= 500 || answer.status === 429 || answer.status === 408;
  if (!answer.ok) throw Object.assign(new Failure(busy ? 'away' : 'missing', `HTTP ${answer.status}`), { status: answer.status });
  return answer;
}

/** Result of reading a body; a connection that drops is none. */
export const whole = (body, signal) => body.catch((error) => {
  throw signal.aborted || error instanceof Failure ? error : new Failure('away', 'the connection dropped');
});

/** Bytes of a file. */
async function fetched({ url, isFirst }, { signal, cache, count }) {
  const answer = await answered(url, { signal, cache }, isFirst), body = new Uint8Array(await whole(answer.arrayBuffer(), signal));
  count(body.length);
  return body;
}

export class Requests {
  /**
   * tell  {changed(): bytes have come; away(isAway): the server does not answer, or does again}
   */
  constructor(tell) {
    Object.assign(this, { tell, list: [], flying: new Map(), tries: new Map(), loaded: 0, timer: 0, isAway: false, ended: new AbortController() });
    window.addEventListener('online', () => this.again(), { signal: this.ended.signal });
  }

  /**
   * Sets all files that are wanted, the most useful first; requests of others are cancelled.
   * list  [{url: of one file alone; bytes: undefined: any number; cache: of fetch; isFirst: as of answered; done(bytes),
   *       failed(kind, reason): 'missing' or 'damaged'; read({signal, cache, count(bytes that have come)}): undefined: the whole of
   *       url}]
   */
  plan(list) {
    this.list = list;
    const urls = new Set(list.map(({ url }) => url));
    for (const [url, { stop }] of this.flying) if (!urls.has(url)) stop.abort();
    this.start();
  }

  /** Nothing is wanted any more. */
  dispose() {
    this.ended.abort();
    this.plan([]);
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
      const read = (cache) => (one.read ?? ((how) => fetched(one, how)))({ signal: stop.signal, cache, count: (bytes) => { this.loaded += bytes; } });
      let body = await read(one.cache ?? 'default');
      if (one.bytes !== undefined && body.length !== one.bytes) body = await read('reload');
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
