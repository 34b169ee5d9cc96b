// slabs.js: volume rendering by value: light added up in depth slabs, four a pass, and composited front to back
// (docs/volume_rendering.md). Nothing is sorted. Slabs are of equal depth over the range of each tile of the picture,
// as in src/render/splat/volume.
import { dot, normalized } from '../vectors.js';
import { axesOf } from '../camera.js';
import { expectedLight } from './transfer.js';

const tile = [64, 32];          // pixels: kTileWidth, kTileHeight
const lightWidth = 1024;        // Gaussians a row: light.vert
const layers = 4;               // slabs a pass: as many images as every device draws into at once
const mostPixels = 1 << 20;     // in the images of slabs; larger pictures are drawn in strips

export class Slabs {
  constructor(renderer) {
    this.renderer = renderer;
    const { gl } = renderer, texture = () => renderer.texture();
    this.table = texture();
    this.light = [texture(), texture(), texture()];
    this.layers = Array.from({ length: layers }, texture);
    this.ranges = texture();
    this.strip = texture();
    this.into = { light: gl.createFramebuffer(), layers: gl.createFramebuffer(), ranges: gl.createFramebuffer(), strip: gl.createFramebuffer() };
    this.lit = null;      // [level's field, transfer function] of the light
    this.allocated = '';  // size of the images
  }

  allocate(width, height, rows) {
    const key = [width, height, rows].join(' ');
    if (this.allocated === key) return;
    this.allocated = key;
    const { renderer } = this;
    for (const texture of [...this.layers, this.strip]) renderer.allocate(texture, 4, width, rows);
    renderer.allocate(this.ranges, 2, Math.ceil(width / tile[0]), Math.ceil(height / tile[1]));
  }

  /** Quadratics of the expected light of all Gaussians. */
  fit(level, field, transfer, source) {
    if (this.lit && this.lit[0] === field && this.lit[1] === transfer) return;
    const { renderer } = this, { gl } = renderer;
    const { data, columns, rows, part, most } = expectedLight(transfer, source);
    gl.bindTexture(gl.TEXTURE_2D, this.table);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, columns, rows, 0, gl.RGBA, gl.FLOAT, data);
    const width = lightWidth, height = Math.max(1, Math.ceil(level.count / width));
    for (const texture of this.light) renderer.allocate(texture, 4, width, height);
    renderer.target(this.into.light, this.light);
    gl.viewport(0, 0, width, height);
    const used = renderer.program('light.vert', ['light.frag']);
    used.use();
    renderer.sample(used, { table: this.table });
    used.set('part', ...part);
    used.set('image_px', width, height);
    gl.bindVertexArray(field.points);
    gl.drawArrays(gl.POINTS, 0, level.count);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.most = most;
    this.lit = [field, transfer];
  }

  /**
   * Adds one sub-frame of the picture to the renderer's sums: premultiplied colours.
   * what  {field: key, source: the page's field, transfer, light: {on, towards, weights}, clip, slabs}
   */
  add(level, model, camera, what) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.wantChannels(4);
    const rows = Math.min(height, Math.max(1, Math.floor(mostPixels / width)));
    this.allocate(width, height, rows);
    gl.clearColor(0, 0, 0, 0);
    if (renderer.subframes === 0) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.framebuffer);
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    if (level && level.count > 0) {
      const field = level.fields.get(what.field);
      this.fit(level, field, what.transfer, what.source);
      this.drawRanges(level, model, camera);
      for (let first = 0; first < height; first += rows) this.drawStrip(level, field, model, camera, what, first, rows);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    ++renderer.subframes;
  }

  drawRanges(level, model, camera) {
    const { renderer } = this, { gl } = renderer;
    renderer.target(this.into.ranges, [this.ranges]);
    gl.viewport(0, 0, Math.ceil(renderer.width / tile[0]), Math.ceil(renderer.height / tile[1]));
    gl.clearBufferfv(gl.COLOR, 0, [-60000, -60000, 0, 0]);  // finite in half floats, too
    const used = renderer.program('splat.vert', ['ranges.frag'], 'RANGES');
    renderer.setView(used, model, camera, null);
    const [light_0, light_1, light_2] = this.light;
    renderer.sample(used, { light_0, light_1, light_2 });
    used.set('tile_px', ...tile);
    renderer.draw(level.array, level.count, gl.MAX);
  }

  drawStrip(level, field, model, camera, what, first, rows) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    const used = renderer.program('splat.vert', ['chord.glsl', 'slab.frag'], 'SLABS');
    const behind = renderer.program('screen.vert', ['layers.frag']);
    const { right, up, forward } = axesOf(camera), towards = what.light.towards;
    renderer.target(this.into.strip, [this.strip]);
    gl.clear(gl.COLOR_BUFFER_BIT);
    for (let slab = 0; slab < what.slabs; slab += layers) {
      renderer.target(this.into.layers, this.layers);
      gl.viewport(0, -first, width, height);
      gl.clear(gl.COLOR_BUFFER_BIT);
      renderer.setView(used, model, camera, what.clip);
      const [light_0, light_1, light_2] = this.light;
      renderer.sample(used, { ranges: this.ranges, light_0, light_1, light_2 });
      used.set('tile_px', ...tile);
      used.set('slabs', what.slabs);
      used.set('first_slab', slab);
      used.set('layers', layers);
      used.set('first_row', first);
      used.set('per_extinction', this.most / model.extinction);
      used.set('lighting', ...(what.light.on ? what.light.weights : [0, 0, 0, 0]));
      const light = towards && Math.hypot(...towards) > 0 ? normalized(towards) : [0, 0, 0];
      used.set('towards_light', dot(light, right), dot(light, up), dot(light, forward));
      renderer.draw(field.array, level.count);

      // Under what is in front.
      renderer.target(this.into.strip, [this.strip]);
      gl.viewport(0, 0, width, rows);
      behind.use();
      const [layer_0, layer_1, layer_2, layer_3] = this.layers;
      renderer.sample(behind, { layer_0, layer_1, layer_2, layer_3 });
      renderer.setScreen(behind, model, camera);
      behind.set('first_row', first);
      gl.enable(gl.BLEND);
      gl.blendEquation(gl.FUNC_ADD);
      gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);
      renderer.screenPass();
      gl.disable(gl.BLEND);
    }
    // The strip to the sums.
    renderer.target(renderer.framebuffer, [renderer.sums]);
    gl.viewport(0, first, width, Math.min(rows, height - first));
    const copy = renderer.program('screen.vert', ['copy.frag']);
    copy.use();
    renderer.sample(copy, { image: this.strip });
    copy.set('first_row', first);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    renderer.screenPass();
    gl.disable(gl.BLEND);
  }
}
