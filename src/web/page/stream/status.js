// status.js: what a streamed page says of its loading: bytes, error of the picture in pixels, a bar while files are under way.
const find = (id) => document.getElementById(id);
const quietMs = 250;  // loading that is over sooner shows no bar

const bytesText = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);
const pixelsText = (pixels) => `${Number(pixels.toPrecision(2))} px`;

let late = 0;  // timer of the bar

/** status  {loaded: bytes, toCome: files, error: pixels, of the picture; isFull: memory bounds it} */
export function showStream({ loaded, toCome, error, isFull }) {
  const line = find('stream'), words = [`${bytesText(loaded)} loaded`, `error ${pixelsText(error)}`];
  if (isFull) words.push('memory full');
  if (toCome > 0) words.push(`${toCome} to come`);
  line.hidden = false;
  line.textContent = words.join(' · ');
  document.documentElement.dataset.loaded = loaded;
  if (toCome === 0) {
    clearTimeout(late);
    late = 0;
    find('progress').hidden = true;
  } else {
    late ||= setTimeout(() => { find('progress').hidden = false; }, quietMs);
  }
}
