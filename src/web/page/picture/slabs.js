// slabs.js: volume rendering by value: moments of a field added up in depth slabs, four a pass (with light two), classified and composited
// front to back (docs/volume_rendering.md); largest values of a field, eight slabs a pass. Nothing is sorted. All slabs have the same depth and divide the
// range of the picture, as in src/render/splat/volume.
import { add, dot, isSame, mul, sub } from '../vectors.js';
import { axesOf } from '../camera.js';
import { coveredBy } from './covered.js';
import { ReachedLight, insideOf, lightsOf, towardsLightCells } from './light.js';
import { hasSurface, lightOf } from './transfer.js';

const tableSize = [1024, 21];   // MeanLight of render/device/expected_light.h
const pieceColumns = 1024;      // expected.glsl
const layers = 4;               // images that every device draws into at once
const slabsOf = { SLABS: 4, LIT: 2, MEANS: 8 };  // a pass, by the word of slab.frag
const leastShare = 1e-3;        // kLeastDensityShare of render/by_value/volume_image.h
const opaque = 1 - 2 ** -14;    // of a pixel behind which nothing is drawn: a sixtieth of a step of its colour
const mostPixels = 1 << 20;     // in the images of slabs; larger pictures are drawn in strips
const reachedUnit = 15;         // of textures
const mostKept = 2 ** 29;       // bytes of kept sums: 32 slabs of a million pixels
const tile = 16;                // pixels a side, of tiles.glsl
const finishShaders = ['erf.glsl', 'expected.glsl', 'tiles.glsl', 'finish.frag'], tableShaders = ['erf.glsl', 'expected.glsl', 'table.frag'];

const wordOf = ({ light, transfer }) => (light.on || transfer?.gradient ? 'LIT' : 'SLABS');
const passesOf = (what) => Math.ceil(what.slabs / slabsOf[wordOf(what)]);
const mostGradientParts = 7;  // of finish.frag

export class Slabs {
  constructor(renderer) {
    this.renderer = renderer;
    const { gl } = renderer, texture = () => renderer.texture(), images = () => Array.from({ length: layers }, texture);
    this.pieces = texture();
    this.table = texture();
    this.ring = [images(), images()];  // of a pass, and of the one before
    this.kept = { images: [], size: '', of: null };  // of all passes of the first sub-frame; of: name of the sums, null: none
    this.room = mostKept;
    this.ranges = texture();
    this.tiles = texture();
    this.rangesOf = null;  // name of their sums, and sub-frame
    this.reached = new ReachedLight(gl, reachedUnit);
    this.lattice = null;   // of the reached light
    this.strip = texture();
    this.densest = texture();
    this.hidden = gl.createRenderbuffer();  // depths: 0 where the strip is opaque
    this.into = Object.fromEntries(['table', 'layers', 'ranges', 'strip', 'densest', 'hidden'].map((name) => [name, gl.createFramebuffer()]));
    renderer.allocate(this.table, 4, ...tableSize);
    renderer.allocate(this.ranges, 2, 1, 1);
    this.light = null;    // {of: what the table has, ...lightOf()}
    this.allocated = '';  // size of the images
  }

  allocate(width, height, rows) {
    const key = [width, height, rows].join(' ');
    this.rows = rows;
    if (this.allocated === key) return;
    this.allocated = key;
    const { renderer } = this;
    for (const texture of [...this.ring.flat(), this.strip]) renderer.allocate(texture, 4, width, rows);
    renderer.allocate(this.densest, 1, width, rows);
    this.inTiles = [width, height].map((n) => Math.ceil(n / tile));
    renderer.allocate(this.tiles, 2, ...this.inTiles);
    this.rangesOf = null;
    const { gl } = renderer;
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.hidden);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, width, rows);
    for (const name of ['layers', 'strip', 'hidden']) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.into[name]);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.hidden);
    }
  }

  /** Largest share of a picture's pixels whose sums have room. */
  shareKept(what, pixels) {
    const bytes = (4 * this.renderer.format.bits * layers * what.slabs) / (8 * slabsOf[wordOf(what)]);
    return Math.min(1, mostPixels / pixels, this.room / (bytes * pixels));
  }

  /** Images of a picture's passes: all, which are kept, or two by turns. */
  imagesOf(what) {
    const { renderer, kept } = this, { gl, width, height } = renderer, passes = passesOf(what), size = [width, height, passes].join(' ');
    if (!what.keep || renderer.subframes > 0 || this.shareKept(what, width * height) < 1) return this.ring;
    if (kept.size === size) return kept.images;
    this.release();
    const images = Array.from({ length: passes }, () => Array.from({ length: layers }, () => renderer.texture()));
    for (const texture of images.flat()) renderer.allocate(texture, 4, width, height);
    this.kept = { images, size, of: null };
    if (gl.getError() !== gl.OUT_OF_MEMORY) return images;
    this.release();
    this.room /= 4;
    return this.imagesOf(what);
  }

  /** Whether the sums of the slabs are there. */
  isDrawn(what) { return Boolean(what.transfer) && this.imagesOf(what) === this.kept.images && this.kept.of === what.of; }

  release() {
    for (const texture of this.kept.images.flat()) this.renderer.gl.deleteTexture(texture);
    this.kept = { images: [], size: '', of: null };
  }

  /** Discards the kept sums: another view; isShown: whether it shows their quantity. */
  restart(isShown) {
    if (isShown) this.kept.of = null;
    else this.release();
  }

  /** Pieces and table of the mean light of a transfer function. */
  setLight(transfer, source) {
    const of = [transfer, ...Object.values(source)];
    if (this.light && isSame(of, this.light.of)) return;
    const { renderer } = this, { gl } = renderer, light = lightOf(transfer, source);
    const rows = Math.ceil(light.pieces.length / pieceColumns), data = new Float32Array(12 * rows * pieceColumns);
    light.pieces.forEach(([start, end, first, last], n) => [[start, end], first, last].forEach((four, k) =>
      data.set(four, 4 * ((3 * Math.floor(n / pieceColumns) + k) * pieceColumns + (n % pieceColumns)))));
    gl.bindTexture(gl.TEXTURE_2D, this.pieces);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, pieceColumns, 3 * rows, 0, gl.RGBA, gl.FLOAT, data);
    this.light = { ...light, of };
    const used = renderer.program('screen.vert', tableShaders);
    renderer.target(this.into.table, [this.table]);
    gl.viewport(0, 0, ...tableSize);
    used.use();
    renderer.sample(used, { pieces: this.pieces });
    used.setInteger('piece_count', light.pieces.length);
    used.set('columns', ...light.columns);
    renderer.screenPass();
  }

  /**
   * Adds one sub-frame of the picture to the renderer's sums: premultiplied colours, or 1 and the largest value.
   * parts  [{gpu, first, count}] of renderer.js
   * what   {field: its place, source: the page's field, transfer: null: the largest value, light: of the state, clip, slabs,
   *         of: name of the sums, keep: whether to keep them, whole: {instances, data} of the whole model, or null, draft: whether ambient occlusion may be coarse}
   */
  add(parts, model, camera, what) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.wantChannels(4);
    const rows = Math.min(height, Math.max(1, Math.floor(mostPixels / width)));
    this.allocate(width, height, rows);
    gl.clearColor(0, 0, 0, 0);
    if (renderer.subframes === 0) {
      renderer.intoSums();
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    if (parts.length > 0) {
      if (what.transfer) {
        this.setLight(what.transfer, what.source);
        this.lattice = this.reached.update(model, this.light, { ...what, camera });
      }
      this.drawRanges(parts, model, camera, what);
      const [left, top, right, bottom] = coveredBy(parts, model, camera, [width, height], renderer.perUnit(model, camera));
      try {
        gl.enable(gl.SCISSOR_TEST);
        for (let first = 0; first < height; first += rows) {
          const above = Math.max(top, first), below = Math.min(bottom, first + rows);
          if (left >= right || above >= below) continue;
          gl.scissor(left, above - first, right - left, below - above);
          this.drawStrip(parts, model, camera, what, first);
          gl.scissor(left, above, right - left, below - above);
          this.copyStrip(first, what.transfer ? '' : 'MEANS');
        }
      } finally {
        gl.disable(gl.SCISSOR_TEST);
        gl.disable(gl.DEPTH_TEST);
      }
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    ++renderer.sums.subframes;
  }

  /** Depths of all Gaussians, and of those above each tile. */
  drawRanges(parts, model, camera, what) {
    const { renderer } = this, { gl } = renderer, of = `${what.of} ${renderer.subframes}`;
    if (this.isDrawn(what) && this.rangesOf === of) return;
    this.rangesOf = of;
    for (const [image, size, word] of [[this.ranges, [1, 1], 'RANGES'], [this.tiles, this.inTiles, 'TILES']]) {
      renderer.target(this.into.ranges, [image]);
      gl.viewport(0, 0, ...size);
      gl.clearBufferfv(gl.COLOR, 0, [-60000, -60000, 0, 0]);  // finite in half floats, too
      renderer.setView(renderer.program('splat.vert', ['ranges.frag'], word), model, camera, null);
      for (const one of parts) renderer.draw(renderer.instancesOf(one, null, ''), one.count, gl.MAX);
    }
  }

  /** Sums all Gaussians in some slabs of a strip. */
  drawLayers(images, parts, model, camera, what, word, first, slab) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.target(this.into.layers, images);
    gl.viewport(0, -first, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const used = renderer.program('splat.vert', ['erf.glsl', 'chord.glsl', 'slab.frag'], word);
    renderer.setView(used, model, camera, what.clip);
    renderer.sample(used, { ranges: this.ranges });
    used.set('slabs', what.slabs);
    used.set('first_slab', slab);
    used.set('layers', slabsOf[word]);
    used.set('central', renderer.format.bits === 32 ? 0 : 1);
    used.set('first_row', first);
    for (const one of parts) renderer.draw(renderer.instancesOf(one, what.field, ''), one.count);
  }

  /** Blends a pass over the layers into an image; first: row of the picture in its first one. */
  gather(image, used, what, first, slab, [layer_0, layer_1, layer_2, layer_3], textures, equation, from, to) {
    const { renderer, ranges, tiles } = this, { gl } = renderer;
    renderer.target(this.into[image], [this[image]]);
    gl.viewport(0, 0, renderer.width, this.rows);
    used.use();
    used.set('slabs', what.slabs);
    used.set('first_slab', slab);
    used.set('first_row', first);
    used.set('central', renderer.format.bits === 32 ? 0 : 1);
    renderer.sample(used, { layer_0, layer_1, layer_2, layer_3, ranges, tiles, ...textures });
    gl.enable(gl.BLEND);
    gl.blendEquation(equation);
    gl.blendFunc(from, to);
    renderer.screenPass();
    gl.disable(gl.BLEND);
  }

  /** Hides opaque pixels of the strip from what is drawn with the test of depths. */
  hideOpaque() {
    const { renderer } = this, { gl } = renderer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.into.hidden);
    const used = renderer.program('screen.vert', ['copy.frag'], 'OPAQUE');
    used.use();
    renderer.sample(used, { image: this.strip });
    used.set('first_row', 0);
    used.set('opaque', opaque);
    gl.depthMask(true);
    gl.depthFunc(gl.ALWAYS);
    gl.depthRange(0, 0);
    renderer.screenPass();
    gl.depthRange(0, 1);
    gl.depthFunc(gl.LESS);
    gl.depthMask(false);
  }

  drawStrip(parts, model, camera, what, first) {
    const { renderer } = this, { gl } = renderer;
    renderer.target(this.into.strip, [this.strip]);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.depthMask(false);
    if (what.transfer) {
      const word = wordOf(what), finish = renderer.program('screen.vert', finishShaders, word);
      this.setFinish(finish, model, camera, what);
      const { table, pieces } = this, passes = passesOf(what), images = this.imagesOf(what);
      // No tau before the first and behind the last slab.
      const nothing = Array(layers).fill(this.densest), isDrawn = this.isDrawn(what);
      renderer.target(this.into.densest, [this.densest]);
      gl.clear(gl.COLOR_BUFFER_BIT);
      // Kept sums are whole: another transfer function may hide less.
      const test = (hides) => (hides ? gl.enable(gl.DEPTH_TEST) : gl.disable(gl.DEPTH_TEST)), isKept = images === this.kept.images;
      // The last slab is composited with what is behind it, nothing.
      for (let pass = 0, before = nothing; pass <= passes; ++pass) {
        const now = pass < passes ? images[pass % images.length] : nothing, [before_0, before_1, before_2, before_3] = before;
        test(!isKept);
        if (pass < passes && !isDrawn) this.drawLayers(now, parts, model, camera, what, word, first, pass * slabsOf[word]);
        test(true);
        // Under what is in front.
        this.gather('strip', finish, what, first, (pass - 1) * slabsOf[word], now, { before_0, before_1, before_2, before_3, table, pieces }, gl.FUNC_ADD, gl.ONE_MINUS_DST_ALPHA, gl.ONE);
        before = now;
        if (pass < passes) this.hideOpaque();
      }
      test(false);
      if (isKept) this.kept.of = what.of;
    } else {
      this.drawMaximum(parts, model, camera, what, first);
    }
  }

  setFinish(used, model, camera, what) {
    const { right, up, forward } = axesOf(camera), { on, weights: [ambient, diffuse, ...shine], shadows, asymmetry } = what.light, { light, renderer, lattice } = this;
    used.use();
    renderer.setScreen(used, model, camera);
    used.setInteger('piece_count', light.pieces.length);
    used.setInteger('exact', light.exact ? 1 : 0);
    used.set('columns', ...light.columns);
    used.set('unit', light.most / model.extinction);
    // GradientFactor: points as shares of the last one.
    const points = what.transfer.gradient ?? [], [most] = points.at(-1) ?? [1];
    const parts = points.slice(1).map(([to, high], n) => [points[n][0] / most, (to - points[n][0]) / most, ((high - points[n][1]) * most) / (to - points[n][0]), 0]);
    used.set('gradient', parts.length, points[0]?.[1] ?? 1, (2 * what.source.unit) / (model.unit * most), 0);
    if (parts.length > 0) used.setList('gradient_part[0]', parts.slice(0, mostGradientParts).flat());
    used.set('parts_per_cell', what.slabs / 32);
    used.set('rounding', 4e-7);
    // Without a light from a direction all light is ambient.
    used.set('lighting', ...(on || shadows ? [ambient, diffuse] : [ambient + diffuse, 0]), shine[0], on ? shine[1] : 0);
    used.set('asymmetry', on || shadows ? asymmetry : 0);
    const lights = on || shadows ? lightsOf(what.light, camera) : [];
    used.setInteger('light_count', lights.length);
    if (lights.length > 0) used.setList('lights[0]', lights.flatMap(({ towards: to, strength }) => [dot(to, right), dot(to, up), dot(to, forward), strength]));
    used.setInteger('reached', reachedUnit);
    used.set('reaches', lattice ? 1 : 0);
    if (!lattice) return;
    const place = (v) => v.map((one, k) => one / (lattice.edge * lattice.size[k])), eye = mul(1 / model.unit, sub(camera.eye, model.center));
    // Centres of texels lie half a cell from the faces.
    used.set('reach_eye', ...place(eye.map((one, k) => one - lattice.first[k] + 0.5 * lattice.edge)));
    used.set('reach_edge', lattice.edge);
    used.set('inside', ...[shadows, what.light.occlusion].map((absorbed) => (absorbed && !on && !hasSurface(what.transfer) ? insideOf(shadows ? what.light.scattering : 1) : 0)));
    const towards = lattice.towards.map((to) => place(mul(towardsLightCells * lattice.edge, to))), zero = [0, 0, 0];
    used.setList('reach_light[0]', [zero, ...towards].slice(towards.length > 0 ? 1 : 0).flatMap((to) => [...to, 0]));
    used.set('reach_middle', ...towards.reduce((sum, to) => add(sum, mul(1 / towards.length, to)), zero));
    used.set('reach_layers', Math.max(towards.length, 1), 0.5 / lattice.size[2]);
    used.set('reach_right', ...place(right));
    used.set('reach_up', ...place(up));
    used.set('reach_forward', ...place(forward));
  }

  /** The largest density of each pixel's slabs, then the largest of the means that count. */
  drawMaximum(parts, model, camera, what, first) {
    const { renderer } = this, { gl } = renderer, { unit, isMeasure } = what.source;
    renderer.target(this.into.densest, [this.densest]);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const used = renderer.program('screen.vert', ['tiles.glsl', 'largest.frag']);
    for (const means of [0, 1]) {
      used.use();
      used.setInteger('of_means', means);
      used.set('least_share', leastShare);
      // A density's mean is at most three times the density (most_share_per_density).
      used.set('most', isMeasure ? 1.5 / unit / model.unit / model.extinction : 0);
      for (let slab = 0; slab < what.slabs; slab += slabsOf.MEANS) {
        this.drawLayers(this.ring[0], parts, model, camera, what, 'MEANS', first, slab);
        this.gather(means ? 'strip' : 'densest', used, what, first, slab, this.ring[0], { densest: means ? this.densest : this.ranges }, gl.MAX, gl.ONE, gl.ONE);
      }
    }
  }

  /** Adds the strip to the sums. */
  copyStrip(first, word) {
    const { renderer } = this, { gl } = renderer, { width, height } = renderer;
    renderer.intoSums();
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
