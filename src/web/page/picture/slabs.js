// slabs.js: volume rendering by value: light added up in depth slabs, four a pass, and composited front to back
// (docs/volume_rendering.md); maxima of a field, eight slabs a pass. Nothing is sorted. Slabs are of equal depth over the range of each tile of the picture,
// as in src/render/splat/volume.
import { dot, normalized } from '../vectors.js';
import { axesOf } from '../camera.js';
import { expectedLight } from './transfer.js';

const tile = [64, 32];          // pixels: kTileWidth, kTileHeight
const lightWidth = 1024;        // Gaussians a row: light.vert
const layers = 4;               // images that every device draws into at once
const slabsOf = { SLABS: 4, MEANS: 8 };  // a pass, by the word of slab.frag
const leastShare = 1e-3;        // kLeastDensityShare of render/by_value/volume_image.h
const mostPixels = 1 << 20;     // in the images of slabs; larger pictures are drawn in strips

export class Slabs {
  constructor(renderer) {
    this.renderer = renderer;
    const { gl } = renderer, texture = () => renderer.texture();
    this.tabled = texture();
    this.layers = Array.from({ length: layers }, texture);
    this.ranges = texture();
    this.strip = texture();
    this.densest = texture();
    this.into = { light: gl.createFramebuffer(), layers: gl.createFramebuffer(), ranges: gl.createFramebuffer(), strip: gl.createFramebuffer(), densest: gl.createFramebuffer() };
    this.table = null;    // {of: what the texture has, part, most}
    this.allocated = '';  // size of the images
  }

  allocate(width, height, rows) {
    const key = [width, height, rows].join(' ');
    this.rows = rows;
    if (this.allocated === key) return;
    this.allocated = key;
    const { renderer } = this;
    for (const texture of [...this.layers, this.strip]) renderer.allocate(texture, 4, width, rows);
    renderer.allocate(this.densest, 1, width, rows);
    renderer.allocate(this.ranges, 2, Math.ceil(width / tile[0]), Math.ceil(height / tile[1]));
  }

  /** Table of the expected light of a transfer function; null: none, for the planes of maxima. */
  setTable(transfer, { reference, unit, isMeasure }) {
    const of = [transfer, reference, unit, isMeasure];
    if (this.table?.of.every((part, n) => part === of[n])) return;
    const { gl } = this.renderer;
    const { data, columns, rows, part, most } = transfer ? expectedLight(transfer, { reference, unit, isMeasure })
      : { columns: 0, part: [0, 0, 0, 0], most: 1 };
    gl.bindTexture(gl.TEXTURE_2D, this.tabled);
    if (columns) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, columns, rows, 0, gl.RGBA, gl.FLOAT, data);
    this.table = { of, part, most };
  }

  /** Quadratics of the expected light of all Gaussians of an upload; without a transfer function their planes. */
  fit(gpu, place) {
    const { renderer } = this, { gl } = renderer, field = gpu.fields.get(place);
    if (field.light?.of === this.table) return;
    const width = lightWidth, height = Math.max(1, Math.ceil(gpu.count / width));
    if (!field.light) {
      field.light = { textures: [0, 1, 2].map(() => renderer.texture()) };
      for (const texture of field.light.textures) renderer.allocate(texture, 4, width, height);
    }
    field.light.of = this.table;
    renderer.target(this.into.light, field.light.textures);
    gl.viewport(0, 0, width, height);
    const used = renderer.program('light.vert', ['light.frag']);
    used.use();
    renderer.sample(used, { table: this.tabled });
    used.set('part', ...this.table.part);
    used.setInteger('planes', this.table.of[0] ? 0 : 1);
    used.set('image_px', width, height);
    gl.bindVertexArray(renderer.pointsOf(gpu, place));
    gl.drawArrays(gl.POINTS, 0, gpu.count);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Draws parts with their light: `used` is in use, with all else set. */
  drawLit(used, parts, place, textures, field, equation) {
    const { renderer } = this;
    for (const one of parts) {
      const [light_0, light_1, light_2] = one.gpu.fields.get(place).light.textures;
      renderer.sample(used, { ...textures, light_0, light_1, light_2 });
      used.setInteger('first_instance', one.first);
      renderer.draw(renderer.instancesOf(one, field, ''), one.count, equation);
    }
  }

  /**
   * Adds one sub-frame of the picture to the renderer's sums: premultiplied colours, or 1 and the largest value.
   * parts  [{gpu, first, count}] of renderer.js
   * what   {field: its place, source: the page's field, transfer: null: the largest value, light: {on, towards, weights}, clip, slabs}
   */
  add(parts, model, camera, what) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.wantChannels(4);
    const rows = Math.min(height, Math.max(1, Math.floor(mostPixels / width)));
    this.allocate(width, height, rows);
    gl.clearColor(0, 0, 0, 0);
    if (renderer.subframes === 0) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.framebuffer);
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    if (parts.length > 0) {
      this.setTable(what.transfer, what.source);
      for (const { gpu } of parts) this.fit(gpu, what.field);
      this.drawRanges(parts, model, camera, what.field);
      for (let first = 0; first < height; first += rows) this.drawStrip(parts, model, camera, what, first);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    ++renderer.subframes;
  }

  drawRanges(parts, model, camera, field) {
    const { renderer } = this, { gl } = renderer;
    renderer.target(this.into.ranges, [this.ranges]);
    gl.viewport(0, 0, Math.ceil(renderer.width / tile[0]), Math.ceil(renderer.height / tile[1]));
    gl.clearBufferfv(gl.COLOR, 0, [-60000, -60000, 0, 0]);  // finite in half floats, too
    const used = renderer.program('splat.vert', ['ranges.frag'], 'RANGES');
    renderer.setView(used, model, camera, null);
    used.set('tile_px', ...tile);
    this.drawLit(used, parts, field, {}, null, gl.MAX);
  }

  /** Adds all Gaussians to some slabs of a strip. */
  drawLayers(parts, model, camera, what, first, slab) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer, word = what.transfer ? 'SLABS' : 'MEANS';
    const used = renderer.program('splat.vert', ['chord.glsl', 'slab.frag'], word);
    const { right, up, forward } = axesOf(camera), towards = what.light.towards;
    renderer.target(this.into.layers, this.layers);
    gl.viewport(0, -first, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT);
    renderer.setView(used, model, camera, what.clip);
    used.set('tile_px', ...tile);
    used.set('slabs', what.slabs);
    used.set('first_slab', slab);
    used.set('layers', slabsOf[word]);
    used.set('first_row', first);
    used.set('per_extinction', what.transfer ? this.table.most / model.extinction : 1);
    used.set('lighting', ...(what.transfer && what.light.on ? what.light.weights : [0, 0, 0, 0]));
    const light = towards && Math.hypot(...towards) > 0 ? normalized(towards) : [0, 0, 0];
    used.set('towards_light', dot(light, right), dot(light, up), dot(light, forward));
    this.drawLit(used, parts, what.field, { ranges: this.ranges }, what.field, gl.FUNC_ADD);
  }

  /** Blends a pass over the layers into an image. */
  gather(image, used, textures, equation, from, to) {
    const { renderer } = this, { gl } = renderer, [layer_0, layer_1, layer_2, layer_3] = this.layers;
    renderer.target(this.into[image], [this[image]]);
    gl.viewport(0, 0, renderer.width, this.rows);
    used.use();
    renderer.sample(used, { layer_0, layer_1, layer_2, layer_3, ...textures });
    gl.enable(gl.BLEND);
    gl.blendEquation(equation);
    gl.blendFunc(from, to);
    renderer.screenPass();
    gl.disable(gl.BLEND);
  }

  drawStrip(parts, model, camera, what, first) {
    const { renderer } = this, { gl } = renderer;
    renderer.target(this.into.strip, [this.strip]);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (what.transfer) {
      const behind = renderer.program('screen.vert', ['layers.frag']);
      behind.use();
      renderer.setScreen(behind, model, camera);
      behind.set('first_row', first);
      for (let slab = 0; slab < what.slabs; slab += slabsOf.SLABS) {
        this.drawLayers(parts, model, camera, what, first, slab);
        this.gather('strip', behind, {}, gl.FUNC_ADD, gl.ONE_MINUS_DST_ALPHA, gl.ONE);  // under what is in front
      }
    } else {
      this.drawMaximum(parts, model, camera, what, first);
    }
    this.copyStrip(first, what.transfer ? '' : 'MEANS');
  }

  /** The largest density of each pixel's slabs, then the largest of the means that count. */
  drawMaximum(parts, model, camera, what, first) {
    const { renderer } = this, { gl } = renderer, { unit, isMeasure } = what.source;
    gl.clearBufferfv(gl.COLOR, 0, [0, -60000, 0, 0]);
    renderer.target(this.into.densest, [this.densest]);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const used = renderer.program('screen.vert', ['largest.frag']);
    for (const means of [0, 1]) {
      used.use();
      used.setInteger('of_means', means);
      used.set('least_share', leastShare);
      // A density's mean is at most three times the density (most_share_per_density); the range is -1 to 1.
      used.set('most', isMeasure ? 3 / unit / model.unit / model.extinction : 0);
      used.set('tile_px', ...tile);
      used.set('slabs', what.slabs);
      used.set('first_row', first);
      for (let slab = 0; slab < what.slabs; slab += slabsOf.MEANS) {
        this.drawLayers(parts, model, camera, what, first, slab);
        this.gather(means ? 'strip' : 'densest', used, { ranges: this.ranges, densest: means ? this.densest : this.ranges }, gl.MAX, gl.ONE, gl.ONE);
      }
    }
  }

  /** Adds the strip to the sums. */
  copyStrip(first, word) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.target(renderer.framebuffer, [renderer.sums]);
    gl.viewport(0, first, width, Math.min(this.rows, height - first));
    const copy = renderer.program('screen.vert', ['copy.frag'], word);
    copy.use();
    renderer.sample(copy, { image: this.strip });
    copy.set('first_row', first);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE);
    renderer.screenPass();
    gl.disable(gl.BLEND);
  }
}
