// renderer.js: WebGL2 renderer with the desktop window's shaders, in two passes: a quad per Gaussian,
// whose fragments add their line integral to T; then the colour of T.
import { sub, mul, dot } from './vectors.js';
import { axesOf, halfTangent } from './camera.js';
import { instanceFloats } from './gaussians.js';
import { sampled } from './colors.js';

// Replaces OpenGL 3.3's header, "#version 330 core".
const header = '#version 300 es\nprecision highp float;\nprecision highp int;\n';
const transferSize = 4096;

function compiled(gl, kind, name, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, header + source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
    throw new Error(`the driver refuses ${name}: ${gl.getShaderInfoLog(shader)}`);
  return shader;
}

/** Linked shaders, with use() and setters of uniforms by name. */
function program(gl, sources, vertex, fragment) {
  const object = gl.createProgram();
  gl.attachShader(object, compiled(gl, gl.VERTEX_SHADER, vertex, sources[vertex]));
  gl.attachShader(object, compiled(gl, gl.FRAGMENT_SHADER, fragment, sources[fragment]));
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
    setInteger: (name, v) => gl.uniform1i(place(name), v),
  };
}

/** Format of T: 32-bit floats, or 16-bit ones on devices without blending of the former. */
function depthFormat(gl, wantHalf) {
  const floats = gl.getExtension('EXT_color_buffer_float');
  const halves = floats || gl.getExtension('EXT_color_buffer_half_float');
  if (floats && gl.getExtension('EXT_float_blend') && !wantHalf)
    return { bits: 32, internal: gl.R32F, type: gl.FLOAT };
  if (halves) return { bits: 16, internal: gl.R16F, type: gl.HALF_FLOAT };
  throw new Error('this graphics driver cannot draw into floating-point images, which the ' +
      'picture is summed up in');
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
    this.format = depthFormat(gl, wantHalf);
    this.splat = program(gl, sources, 'splat.vert', 'splat.frag');
    this.screen = program(gl, sources, 'screen.vert', 'shade.frag');
    this.nothing = gl.createVertexArray();
    this.transfer = this.texture();
    this.depth = this.texture();
    this.framebuffer = gl.createFramebuffer();
    this.width = this.height = 0;
    this.subframes = 0;
    this.resize(1, 1);
  }

  texture() {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
      gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Copies the instances of one level to the GPU. */
  upload(instances) {
    const gl = this.gl, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, instances, gl.STATIC_DRAW);
    [[0, 4, 0], [1, 3, 4], [2, 4, 7]].forEach(([place, count, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * instanceFloats, 4 * offset);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
    return { array, buffer, count: instances.length / instanceFloats };
  }

  release(level) {
    this.gl.deleteVertexArray(level.array);
    this.gl.deleteBuffer(level.buffer);
  }

  resize(width, height) {
    if (width === this.width && height === this.height) return;
    const gl = this.gl;
    [this.width, this.height] = [width, height];
    gl.bindTexture(gl.TEXTURE_2D, this.depth);
    gl.texImage2D(gl.TEXTURE_2D, 0, this.format.internal, width, height, 0, gl.RED,
                  this.format.type, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.depth, 0);
    const whole = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    if (!whole && !gl.isContextLost())
      throw new Error(`this graphics driver cannot draw into ${this.format.bits}-bit floats`);
  }

  /** Discards the sum of sub-frames. */
  restart() { this.subframes = 0; }

  /** Adds one sub-frame of T; the instances include the extinction. */
  addDepth(level, model, camera) {
    const gl = this.gl, { width, height } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.viewport(0, 0, width, height);
    if (this.subframes === 0) {
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT);
    }
    if (level && level.count > 0) {
      const { right, up, forward } = axesOf(camera);
      // In double precision, along the camera's axes, so that distance does not reduce accuracy.
      const eye = mul(1 / model.unit, sub(camera.eye, model.center));
      this.splat.use();
      this.splat.set('eye', dot(eye, right), dot(eye, up), dot(eye, forward));
      this.splat.set('right', ...right);
      this.splat.set('up', ...up);
      this.splat.set('forward', ...forward);
      this.splat.set('size_px', width, height);
      this.splat.set('jitter_px', ...jitterOf(this.subframes));
      this.splat.set('pixels_per_unit', camera.span
        ? (Math.min(width, height) * model.unit) / camera.span
        : (0.5 * Math.min(width, height)) / halfTangent(camera));
      this.splat.set('parallel', camera.span ? 1 : 0);
      this.splat.set('cutoff', model.cutoff);
      this.splat.set('limits', ...(this.subframes === 0 ? model.limits : model.subframeLimits));
      gl.enable(gl.BLEND);
      gl.blendEquation(gl.FUNC_ADD);
      gl.blendFunc(gl.ONE, gl.ONE);
      gl.bindVertexArray(level.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, level.count);
      gl.bindVertexArray(null);
      gl.disable(gl.BLEND);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    ++this.subframes;
  }

  setMap(map) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.transfer);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, transferSize, 1, 0, gl.RGBA, gl.FLOAT,
                  sampled(map, transferSize, 2));
  }

  /**
   * Colours T on the canvas.
   * look  {exposure, fade, background}
   */
  shade(look) {
    const gl = this.gl, { width, height, screen } = this;
    gl.viewport(0, 0, width, height);
    screen.use();
    [this.depth, this.depth, this.transfer].forEach((texture, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    gl.activeTexture(gl.TEXTURE0);
    ['depth_a', 'depth_b', 'transfer'].forEach((name, unit) => screen.setInteger(name, unit));
    const factor = look.exposure / Math.max(this.subframes, 1);
    for (const side of ['a', 'b']) {
      screen.set(`size_${side}`, width, height);
      screen.set(`factor_${side}`, factor);
    }
    screen.set('transfer_size', transferSize);
    screen.set('background', ...look.background);
    screen.setInteger('blend', look.fade ? 1 : 0);
    screen.setInteger('checker', 0);
    screen.setInteger('difference', 0);
    screen.set('difference_limit', 1);
    screen.set('split', 2);  // the whole width shows image A
    screen.set('viewport_px', width, height);
    screen.set('viewport_origin_px', 0, 0);
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
  }
}
