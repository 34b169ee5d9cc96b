// input.js: conversion of mouse, touch, wheel and key events to camera motions and commands.
import { rotated, lookedAround, rolled, panned, zoomed } from './camera.js';
import { dragLight, hasLight, leastDistance, windowed } from './view/motions.js';

/** Screen point (camera.js) of page coordinates. */
function pointOf(canvas, x, y) {
  const box = canvas.getBoundingClientRect(), half = 0.5 * Math.min(box.width, box.height);
  return [(x - box.left - 0.5 * box.width) / half, (box.top + 0.5 * box.height - y) / half];
}

/** Camera after a drag between two screen points, by button and modifier as in the window. */
function dragged(event, camera, from, to, leastDistance) {
  if (event.buttons & 2) return zoomed(camera, [0, 0], Math.exp(-2 * (to[1] - from[1])), leastDistance);
  if (event.buttons & 4 || event.shiftKey) return panned(camera, from, to);
  if (event.altKey) return rolled(camera, Math.atan2(from[1], from[0]) - Math.atan2(to[1], to[0]));
  if (event.ctrlKey || event.metaKey) return lookedAround(camera, from[0] - to[0], from[1] - to[1]);
  return rotated(camera, from, to);
}

/** Camera after a motion of two fingers, which keep their points of the picture. */
function pinched(camera, before, after, leastDistance) {
  const middle = ([a, b]) => [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
  const apart = ([a, b]) => [b[0] - a[0], b[1] - a[1]];
  const from = apart(before), to = apart(after);
  const factor = Math.hypot(...from) / Math.max(Math.hypot(...to), 1e-3);
  let angle = Math.atan2(from[1], from[0]) - Math.atan2(to[1], to[0]);
  angle = Math.atan2(Math.sin(angle), Math.cos(angle));
  const moved = panned(camera, middle(before), middle(after));
  return rolled(zoomed(moved, middle(after), factor, leastDistance), angle);
}

/**
 * Attaches pointer and wheel events of a Viewer's canvas.
 * signal  ends them
 */
export function attachPointers(canvas, view, signal) {
  const pointers = new Map();
  let begun = null;  // camera before the first of them
  const place = (event) => pointOf(canvas, event.clientX, event.clientY);
  const on = (name, listener) => canvas.addEventListener(name, listener, { passive: false, signal });

  on('pointerdown', (event) => {
    if (view.state.still) return;
    // A finger may be about to scroll the page.
    if (event.pointerType !== 'touch') canvas.focus({ preventScroll: true });
    if (pointers.size === 0) begun = view.state.camera;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
  });
  on('pointermove', (event) => {
    const from = pointers.get(event.pointerId);
    if (!from || view.state.still) return;
    const before = [...pointers.values()], to = place(event);
    pointers.set(event.pointerId, to);
    const { camera } = view.state, least = leastDistance(view);
    if (before.length === 1 && event.buttons & 2 && event.ctrlKey && hasLight(view)) return dragLight(view, to.map((v, k) => v - from[k]));
    if (before.length === 1 && event.buttons & 2 && windowed(view, 0.5 * (to[0] - from[0]), 0.5 * (to[1] - from[1]))) return;
    if (before.length === 1) view.move(dragged(event, camera, from, to, least));
    if (before.length === 2) view.move(pinched(camera, before, [...pointers.values()], least));
  });
  // The browser scrolls the page: the motion was its own.
  on('pointercancel', () => { if (pointers.size > 0 && view.state.camera !== begun) view.move(begun); });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'])
    on(end, (event) => pointers.delete(event.pointerId));
  on('click', () => { if (!view.state.still) canvas.focus({ preventScroll: true }); });
  on('contextmenu', (event) => event.preventDefault());

  on('wheel', (event) => {
    // In an embedded page the wheel scrolls the outer page until the picture is clicked.
    const pinch = event.ctrlKey;  // browsers report a trackpad's pinch as Ctrl + wheel
    if (view.state.still || (view.state.embed && !pinch && canvas.getRootNode().activeElement !== canvas)) return;
    event.preventDefault();
    const pixels = event.deltaY * [1, 16, 400][event.deltaMode];
    const steps = Math.max(-240, Math.min(240, pixels)) * (pinch ? 0.01 : 0.0015);
    const point = place(event);
    view.move(zoomed(view.state.camera, point, Math.exp(steps), leastDistance(view)));
  });
}

/**
 * Attaches keys to an element, or to a window for any focus, except where a focused control uses the key itself.
 * commands  {key: function of the event; returns false where it has no effect}, by KeyboardEvent.key, or code for digits
 */
export function attachKeys(target, commands, signal) {
  target.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const name = event.code.startsWith('Digit') ? event.code : event.key.toLowerCase();
    const inControl = event.target.closest?.('input, select, button, a, dialog');
    if (inControl && /^(arrow|page|home|end|enter| )/.test(name)) return;
    if (inControl?.tagName === 'SELECT' && /^[a-z]$/.test(name)) return;
    if (commands[name] && commands[name](event) !== false) event.preventDefault();
  }, { signal });
}
