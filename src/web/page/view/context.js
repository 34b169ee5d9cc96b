// context.js: the loss of a canvas's WebGL context, and its return. Browsers keep about 16 contexts, and take the oldest one for a further canvas.
const patienceMs = 3000;  // of a driver that restarts: some 1 s
const soonMs = 500;       // in which a browser may return a context itself

const stopped = new Set();  // views whose contexts do not come back; one of them begins anew where another view ends
let freed = 0;              // contexts of views that have ended

/** Attaches the context's events of a Viewer. */
export function attachContext(view, signal) {
  const { canvas, tell } = view;
  let waiting = 0;
  const stop = (before) => {
    if (freed > before && tell.reopen) return tell.reopen();
    stopped.add(view);
    tell.say('This browser shows no more 3D views at a time: close others or reload.', 0);
  };
  signal.addEventListener('abort', () => clearTimeout(waiting));
  canvas.addEventListener('webglcontextlost', (event) => {
    if (signal.aborted) return;
    event.preventDefault();
    view.lost = true;
    tell.say('The graphics driver restarts …', 0);
    waiting = setTimeout(stop, patienceMs, freed);
  }, { signal });
  canvas.addEventListener('webglcontextrestored', () => {
    clearTimeout(waiting);
    stopped.delete(view);
    view.lost = false;
    tell.say('');
    view.restart();
    view.redraw();
  }, { signal });
}

/** A view ends: its context may be another one's. */
export function freeContext(view) {
  stopped.delete(view);
  if (view.lost) return;
  ++freed;
  setTimeout(() => {
    const [next] = stopped;
    next?.tell.reopen?.();
  }, soonMs);
}
