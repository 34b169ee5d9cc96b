// motions.js: what hands and keys do to a Viewer: motions of its camera, exposure, colours, and the values of a right drag.
import { mul } from '../vectors.js';
import { fitted, flown, orbited, rolled, seenFrom, withOtherProjection } from '../camera.js';
import { draggedLights } from '../picture/light.js';
import { remapped } from '../picture/transfer.js';

const degrees5 = Math.PI / 36;

/** Nearest that a zoom comes to the centre of the view, world units. */
export const leastDistance = (view) => 0.02 * view.box.radius;

/** Commands by their keys, as attachKeys takes them. */
export function motions(view) {
  const moved = (to) => (event) => view.move(to(view.state.camera, event));
  const fly = (...way) => moved((camera) => flown(camera, ...mul(0.05 * view.box.radius, way)));
  const turn = (x, y) => moved((camera) => orbited(camera, x * degrees5, y * degrees5));
  const roll = (sign) => moved((camera) => rolled(camera, sign * degrees5));
  const look = (axis) => moved((camera, event) => seenFrom(camera, view.box, axis, event.shiftKey ? -1 : 1, view.page.upright));
  const expose = (factor) => () => view.change({ exposure: factor ? Math.max(1 / 64, Math.min(64, view.state.exposure * factor)) : 1 });
  const detail = (step) => () => view.change(view.source.detailed(view.source.detail().value + step));
  const commands = {
    w: fly(0, 0, 1), s: fly(0, 0, -1), a: fly(-1, 0, 0), d: fly(1, 0, 0), pageup: fly(0, 1, 0), pagedown: fly(0, -1, 0),
    arrowleft: turn(-1, 0), arrowright: turn(1, 0), arrowup: turn(0, 1), arrowdown: turn(0, -1), q: roll(-1), e: roll(1),
    Digit1: look(0), Digit2: look(1), Digit3: look(2), Digit5: moved(withOtherProjection),
    home: moved(() => view.home), f: moved((camera) => fitted(camera, view.box)),
    '[': detail(-1), ']': detail(1), '-': expose(1 / Math.SQRT2), '=': expose(Math.SQRT2), '+': expose(Math.SQRT2), Digit0: expose(0),
    m: (event) => nextMap(view, event.shiftKey ? -1 : 1), i: () => view.change({ reverse: !view.state.reverse }), b: () => view.change({ fade: !view.state.fade }),
    n: () => view.change({ model: (view.state.model + 1) % view.page.models.length }),
  };
  return Object.fromEntries(Object.entries(commands).map(([key, command]) => [key, (event) => !view.state.still && command(event)]));
}

function nextMap(view, step) {
  const names = view.page.maps.map(({ name }) => name), { length } = names;
  view.change({ map: names[(names.indexOf(view.state.map) + length + step) % length] });
}

/** Whether the picture has a light to drag: a volume's that shades surfaces or casts shadows. */
export const hasLight = ({ state: { show, light } }) => show === 'volume' && (light.on || light.shadows);

/** Turns the first light by a step over the picture. */
export function dragLight(view, step) {
  const { light, camera } = view.state;
  view.change({ light: { ...light, lights: draggedLights(light, camera, step) } });
}

/** An edited transfer function of the shown field, a unit of 0 for the field's own; null: the first one again. */
export function setTransfer(view, transfer) {
  const { transfers, field } = view.state, { [field]: _, ...others } = transfers, unit = transfer?.unit || view.models[0].fields[field]?.unitDistance;
  view.change({ transfers: transfer ? { ...others, [field]: { ...transfer, unit } } : others });
}

/**
 * Level and width of the shown values by a drag, as radiologists have it; shares of the picture's height.
 * returns  whether the quantity has such values
 */
export function windowed(view, rightwards, upwards) {
  const { show } = view.state;
  if (show === 'T') return false;
  const narrowed = (low, high) => {
    const middle = 0.5 * (low + high) - upwards * (high - low), width = (high - low) * Math.exp(2 * rightwards);
    return (v) => middle + ((v - 0.5 * (low + high)) / (high - low)) * width;
  };
  if (show === 'volume') {
    const { transfer } = view, values = [...transfer.colors, ...transfer.opacity].map(([v]) => v);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    if (high > low) setTransfer(view, remapped(transfer, narrowed(low, high)));
  } else {
    const { scale } = view, to = narrowed(scale.low, scale.high), [low, high] = [to(scale.low), to(scale.high)];
    if (low < high && !(scale.log && low <= 0)) view.change({ scale: { ...scale, low, high } });
  }
  return true;
}
