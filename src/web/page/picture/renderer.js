// renderer.js: WebGL2 renderer with the desktop window's shaders: quads of the Gaussians, whose fragments add their
// line integrals to sums (T, or the sums of a field), or to depth slabs (slabs.js); then the colour of the sums.
import { isSame, sub, mul, dot } from '../vectors.js';
import { axesOf, halfTangent } from '../camera.js';
import { instanceFloats } from '../model/gaussians.js';
import { scalarFloats, vectorFloats } from '../model/fields.js';
import { sampled } from './colors.js';
import { boxOf } from './covered.js';
import { planesOf } from './clip.js';

// Replaces OpenGL 3.3's header, "#version 330 core".
const header = '#version 300 es\nprecision highp float;\nprecision highp int;\n';
const transferSize = 4096;
const mostKept = 4;  // pictures of sums of one view

function compiled(gl, kind, name, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, header + source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
    throw new Error(`the driver refuses ${name}: ${gl.getShaderInfoLog(shader)}`);
  return shader;
}

/**
 * Linked shaders, with use() and setters of uniforms by name.
 * word  defined in both, as splat.vert asks; '': none
 */
function program(gl, sources, vertex, fragments, word = '') {
  const object = gl.createProgram(), define = word && `#define ${word}\n`;
  const text = fragments.map((name) => sources[name]).join('\n');
  gl.attachShader(object, compiled(gl, gl.VERTEX_SHADER, vertex, define + sources[vertex]));
  gl.attachShader(object, compiled(gl, gl.FRAGMENT_SHADER, fragments.at(-1), define + text));
  gl.linkProgram(object);
  if (!gl.getProgramParameter(object, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`the driver refuses ${vertex}: ${gl.getProgramInfoLog(object)}`);
  const places = new Map();
  const place = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(object, name));
    return places.get(name);
  };
  return {
    use: () => gl.useProgram(object),
    set: (name, ...v) => gl[`uniform${v.length}f`](place(name), ...v),
    setList: (name, v) => gl.uniform4fv(place(name), v),
    setInteger: (name, v) => gl.uniform1i(place(name), v),
  };
}

/** Formats of sums: 32-bit floats, or 16-bit ones on devices without blending of the former. */
function sumFormat(gl, wantHalf) {
  const floats = gl.getExtension('EXT_color_buffer_float');
  const halves = floats || gl.getExtension('EXT_color_buffer_half_float');
  if (floats && gl.getExtension('EXT_float_blend') && !wantHalf)
    return { bits: 32, one: gl.R32F, two: gl.RG32F, four: gl.RGBA32F, type: gl.FLOAT };
  if (halves) return { bits: 16, one: gl.R16F, two: gl.RG16F, four: gl.RGBA16F, type: gl.HALF_FLOAT };
  throw new Error('this graphics driver cannot draw into floating-point images, which the picture is summed up in');
}

/** Offset of the rays of sub-frame n from pixel centres: jitter_of in apps/viewer/gl/splat_gl.cpp. */
function jitterOf(n) {
  const centred = (v) => v - Math.floor(v + 0.5);
  return [centred(n * 0.7548776662466927), centred(n * 0.5698402909980532)];
}

export class Renderer {
  /**
   * sources   shaders by file name
   * wantHalf  use 16-bit floats on every device
   * throws    Error with a message for the reader if the device is not supported
   */
  constructor(canvas, sources, wantHalf) {
    const gl = canvas.getContext('webgl2', {
      antialias: false, depth: false, premultipliedAlpha: false, powerPreference: 'high-performance',
    });
    if (!gl) throw new Error('this browser offers no WebGL 2, or it is switched off');
    this.gl = gl;
    this.sources = sources;
    this.format = sumFormat(gl, wantHalf);
    this.programs = new Map();
    this.program('splat.vert', ['splat.frag']);  // refused here rather than later
    this.screen = this.program('screen.vert', ['shade.frag']);
    this.nothing = gl.createVertexArray();
    this.transfer = this.texture();
    this.framebuffer = gl.createFramebuffer();
    this.draws = 0;         // of parts, all passes
    this.kept = new Map();  // of the current view, the last used last: sums by name, {texture, channels, subframes, finish}
    this.width = this.height = 0;
    this.choose('');
    this.resize(1, 1);
    this.wantChannels(1);
  }

  /** Linked shaders, compiled when first asked for. */
  program(vertex, fragments, word = '') {
    const key = [vertex, ...fragments, word].join(' ');
    if (!this.programs.has(key)) this.programs.set(key, program(this.gl, this.sources, vertex, fragments, word));
    return this.programs.get(key);
  }

  texture() {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Memory of a texture of sums; channels 1, 2 or 4. */
  allocate(texture, channels, width, height) {
    const gl = this.gl, { type, one, two, four } = this.format;
    const [internal, format] = { 1: [one, gl.RED], 2: [two, gl.RG], 4: [four, gl.RGBA] }[channels];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, null);
  }

  /** Attaches textures to a framebuffer, and binds it. */
  target(framebuffer, textures) {
    const gl = this.gl, places = textures.map((_, n) => gl.COLOR_ATTACHMENT0 + n);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    textures.forEach((texture, n) => gl.framebufferTexture2D(gl.FRAMEBUFFER, places[n], gl.TEXTURE_2D, texture, 0));
    gl.drawBuffers(places);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE || gl.isContextLost()) return;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    throw new Error(`this graphics driver cannot draw into ${this.format.bits}-bit floats`);
  }

  /** Binds textures to samplers of a program in use. */
  sample(used, textures) {
    const gl = this.gl;
    Object.entries(textures).forEach(([name, texture], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      used.setInteger(name, unit);
    });
    gl.activeTexture(gl.TEXTURE0);
  }

  screenPass() {
    const gl = this.gl;
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
  }

  /** Attributes [place, count, offset] of a buffer, one set an instance, in the bound array. */
  attributes(buffer, floats, places) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const [place, count, offset] of places) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * floats, 4 * offset);
      gl.vertexAttribDivisor(place, 1);
    }
  }

  filled(data) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return buffer;
  }

  // Gaussians of a model, level or chunk in the GPU's memory: {count, buffer, box, fields: Map of places to {buffer, vector}, arrays}. A picture shows a list of parts, [{gpu, first, count}].

  /** Copies instances to the GPU. */
  upload(instances, cutoff) {
    return { count: instances.length / instanceFloats, buffer: this.filled(instances), box: boxOf(instances, cutoff), fields: new Map(), arrays: new Map() };
  }

  /** Copies a field of uploaded instances to the GPU; `field` is its place among the model's. */
  uploadField(gpu, field, data, vector) {
    gpu.fields.set(field, { buffer: this.filled(data), vector });
  }

  /** Vertex array `key`, made when first asked for. */
  arrayOf(gpu, key, make) {
    if (!gpu.arrays.has(key)) {
      const array = this.gl.createVertexArray();
      this.gl.bindVertexArray(array);
      make();
      this.gl.bindVertexArray(null);
      gpu.arrays.set(key, array);
    }
    return gpu.arrays.get(key);
  }

  /**
   * Instances from `first` on, an instance each.
   * field  null: none
   * part   of a vector field 'view', 'x', 'y', 'z' or 'magnitude'; else ''
   */
  instancesOf({ gpu, first }, field, part) {
    return this.arrayOf(gpu, [field ?? '', part, first].join('.'), () => {
      const shift = (floats, places) => places.map(([place, count, offset]) => [place, count, offset + first * floats]);
      this.attributes(gpu.buffer, instanceFloats, shift(instanceFloats, [[0, 4, 0], [1, 3, 4], [2, 4, 7]]));
      if (field === null) return;
      const { buffer, vector } = gpu.fields.get(field), axis = 'xyz'.indexOf(part);
      if (!vector) this.attributes(buffer, scalarFloats, shift(scalarFloats, [[3, 4, 0], [4, 2, 4]]));
      else if (part === 'view' || part === 'magnitude')
        this.attributes(buffer, vectorFloats, shift(vectorFloats, [[3, 4, 0], [4, 4, 4], [5, 4, 8], [6, 4, 12], [7, 2, 16]]));
      else this.attributes(buffer, vectorFloats, shift(vectorFloats, [[3, 4, 4 * axis], [4, 1, 18 + axis]]));
    });
  }

  releaseField(gpu, place) {
    this.gl.deleteBuffer(gpu.fields.get(place).buffer);
    gpu.fields.delete(place);
    for (const [key, array] of gpu.arrays) {
      if (!key.startsWith(`${place}.`)) continue;
      this.gl.deleteVertexArray(array);
      gpu.arrays.delete(key);
    }
  }

  release(gpu) {
    for (const place of [...gpu.fields.keys()]) this.releaseField(gpu, place);
    for (const array of gpu.arrays.values()) this.gl.deleteVertexArray(array);
    this.gl.deleteBuffer(gpu.buffer);
  }

  /** Copies back what upload and uploadField of a scalar field took: {instances, data}. */
  readBack(gpu, field) {
    const gl = this.gl;
    const numbers = (buffer, floats) => {
      const out = new Float32Array(gpu.count * floats);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.getBufferSubData(gl.ARRAY_BUFFER, 0, out);
      return out;
    };
    return { instances: numbers(gpu.buffer, instanceFloats), data: numbers(gpu.fields.get(field).buffer, scalarFloats) };
  }

  resize(width, height) {
    if (width === this.width && height === this.height) return;
    [this.width, this.height] = [width, height];
    this.restart();
    this.sums.channels = 0;
  }

  /**
   * Makes sums the current ones: those kept under a name, else empty ones.
   * finish  list of what they were made with after drawing: with others they are made anew
   */
  choose(name, finish = []) {
    const isKept = this.kept.has(name), from = isKept || this.kept.size < mostKept ? name : this.kept.keys().next().value;
    this.sums = this.kept.get(from) ?? { texture: this.texture(), channels: 0 };
    if (!isKept || !isSame(finish, this.sums.finish)) Object.assign(this.sums, { subframes: 0, finish });
    this.kept.delete(from);
    this.kept.set(name, this.sums);
  }

  /** Sub-frames in the current sums. */
  get subframes() { return this.sums.subframes; }

  /** Sums of 1 channel (T) or 4. */
  wantChannels(channels) {
    if (this.sums.channels === channels) return;
    Object.assign(this.sums, { channels, subframes: 0 });
    this.allocate(this.sums.texture, channels, this.width, this.height);
    this.intoSums();
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
  }

  intoSums() { this.target(this.framebuffer, [this.sums.texture]); }

  /** Discards all sums: another view. */
  restart() {
    for (const [name, sums] of this.kept) if (sums !== this.sums && this.kept.delete(name)) this.gl.deleteTexture(sums.texture);
    this.sums.subframes = 0;
  }

  /** Sets a camera's uniforms of splat.vert and the fragments that follow it. */
  setView(used, model, camera, clip) {
    const { right, up, forward } = axesOf(camera);
    // In double precision, along the camera's axes, so that distance does not reduce accuracy.
    const along = (v) => [dot(v, right), dot(v, up), dot(v, forward)];
    used.use();
    used.set('eye', ...along(mul(1 / model.unit, sub(camera.eye, model.center))));
    used.set('right', ...right);
    used.set('up', ...up);
    used.set('forward', ...forward);
    this.setScreen(used, model, camera);
    used.set('cutoff', model.cutoff);
    used.set('limits', ...(this.subframes === 0 ? model.limits : model.subframeLimits));
    used.set('first_row', 0);
    const planes = planesOf(clip);
    used.setInteger('clip_planes', planes.length);
    if (planes.length > 0)
      used.setList('clip_plane[0]', planes.flatMap(([normal, offset]) =>
        [...along(normal), (offset - dot(normal, camera.eye)) / model.unit]));
  }

  /** Pixels a unit of slope; of parallel rays, a unit of length. */
  perUnit(model, camera) {
    const side = Math.min(this.width, this.height);
    return camera.span ? (side * model.unit) / camera.span : (0.5 * side) / halfTangent(camera);
  }

  setScreen(used, model, camera) {
    used.set('size_px', this.width, this.height);
    used.set('pixels_per_unit', this.perUnit(model, camera));
    used.set('parallel', camera.span ? 1 : 0);
    used.set('jitter_px', ...jitterOf(this.subframes));
  }

  /** Adds Gaussians to the bound framebuffer. */
  draw(array, count, equation = this.gl.FUNC_ADD) {
    const gl = this.gl;
    ++this.draws;
    gl.enable(gl.BLEND);
    gl.blendEquation(equation);
    gl.blendFunc(gl.ONE, gl.ONE);
    gl.bindVertexArray(array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.bindVertexArray(null);
    gl.disable(gl.BLEND);
  }

  /**
   * Adds one sub-frame of sums; the instances include the extinction.
   * parts  [{gpu, first, count}]
   * what   {field: as of instancesOf, part, clip of clip.js}
   */
  addSums(parts, model, camera, what) {
    const gl = this.gl, exact = what.field !== null || planesOf(what.clip).length > 0;
    this.wantChannels(exact ? 4 : 1);
    this.intoSums();
    gl.viewport(0, 0, this.width, this.height);
    if (this.subframes === 0) {
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    if (parts.length > 0) {
      const used = exact
        ? this.program('splat.vert', ['erf.glsl', 'chord.glsl', 'field.frag'], what.part === 'view' || what.part === 'magnitude' ? 'VECTOR' : 'SCALAR')
        : this.program('splat.vert', ['splat.frag']);
      this.setView(used, model, camera, what.clip);
      if (exact) used.setInteger('magnitude', what.part === 'magnitude' ? 1 : 0);
      // Without a field: the value 0.
      gl.vertexAttrib4f(3, 0, 0, 0, 0);
      gl.vertexAttrib4f(4, 0, 0, 0, 0);
      for (const one of parts) this.draw(this.instancesOf(one, what.field, what.part), one.count);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    ++this.sums.subframes;
  }

  setMap(map) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.transfer);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, transferSize, 1, 0, gl.RGBA, gl.FLOAT, sampled(map, transferSize, 2));
  }

  /**
   * Colours the sums on the canvas.
   * look  {quantity, factor, scale: {low, high, log}, unit: [reference, unit], leastColumn, fade, background}
   */
  shade(look) {
    const gl = this.gl, { width, height, screen } = this, { drawingBufferWidth: across, drawingBufferHeight: down } = gl;
    gl.viewport(0, 0, across, down);
    screen.use();
    this.sample(screen, { depth_a: this.sums.texture, depth_b: this.sums.texture, transfer: this.transfer });
    const factor = look.factor / Math.max(this.subframes, 1);
    for (const side of ['a', 'b']) {
      screen.set(`size_${side}`, width, height);
      screen.set(`factor_${side}`, factor);
    }
    screen.setInteger('quantity', look.quantity);
    screen.set('scale_ends', look.scale.low, look.scale.high);
    screen.setInteger('log_scale', look.scale.log ? 1 : 0);
    screen.set('field_unit', ...look.unit);
    screen.set('least_column', look.leastColumn);
    screen.set('transfer_size', transferSize);
    screen.set('background', ...look.background);
    screen.setInteger('blend', look.fade ? 1 : 0);
    screen.setInteger('checker', 0);
    screen.setInteger('difference', 0);
    screen.set('difference_limit', 1);
    screen.set('split', 2);  // the whole width shows image A
    screen.set('viewport_px', across, down);
    screen.set('viewport_origin_px', 0, 0);
    this.screenPass();
  }

  /** Sums of a rectangle of pixels, of all sub-frames: [height][width][4]. */
  read(x, y, width, height) {
    const gl = this.gl, sums = new Float32Array(4 * width * height);
    this.intoSums();
    gl.readPixels(x, y, width, height, gl.RGBA, gl.FLOAT, sums);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return sums;
  }

  /** Sums of one pixel, from the top left; null: none. */
  sumsAt(x, y) {
    if (this.subframes === 0 || x < 0 || y < 0 || x >= this.width || y >= this.height) return null;
    return [...this.read(x, y, 1, 1)].map((v) => v / this.subframes);
  }
}
