// described.js: the page of models that are nothing but an address: what vog page and vog pack have written of it, checked.
import { Refused, areNumbers, isObject, refuse } from '../stream/rows.js';

/** Throws unless numbers are where a view needs them. */
function checkNumbers(of, counts, where) {
  for (const [key, count] of Object.entries(counts))
    if (!areNumbers(count > 1 ? of?.[key] : [of?.[key]], count)) refuse(`${where}: ${key}`, of?.[key], count > 1 ? `${count} numbers` : 'a number');
}

/**
 * The page of models that are nothing but an address.
 * about   what a view of them begins with, as vog page and vog pack have written it: {camera, upright, chosenView, models}
 * models  their descriptions
 * site    of Site
 */
export function pageOf({ lightWeights, ...given }, about, models, { steps, ...site }, name) {
  if (!isObject(about) || !Array.isArray(about.models) || about.models.length !== models.length)
    throw new Refused(site.file ? `${name}: has no levels of detail; write it with: vog pack MODEL -o FILE.vogz --hierarchy --deflate`
      : `${name}: describes other models; write it with: vog page MODEL -o FOLDER/`);
  const { camera, upright, chosenView, models: entries } = about;
  checkNumbers(about, { upright: 3 }, name);
  checkNumbers(camera, { eye: 3, look_at: 3, up: 3 }, `${name}: camera`);
  entries.forEach((entry, n) => {
    const where = `${name}: models[${n}]`;
    checkNumbers(entry, { center: 3, unit: 1, cutoff: 1, limits: 4, subframeLimits: 4, extinction: 1, lowColumn: 1, mostColumn: 1 }, where);
    checkNumbers(entry.box, { center: 3, half: 3, radius: 1 }, `${where}.box`);
    if (!Array.isArray(entry.fields)) refuse(`${where}.fields`, entry.fields, 'a list');
    entry.fields.forEach((field, k) => checkNumbers(field, { lower: 1, upper: 1, reference: 1, scale: 1, ...(!field?.vector && { unitDistance: 1, values: 2 }) }, `${where}.fields[${k}]`));
  });
  return {
    ...given, maps: [...given.maps], title: models[0].name, picture: { camera, light_weights: lightWeights }, upright, chosenView: chosenView === true,
    systemBackground: false, background: [0, 0, 0, 0], steps, site, models: entries.map((entry, n) => ({ ...entry, name: models[n].name, levels: [] })),
  };
}
