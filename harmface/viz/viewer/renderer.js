// WebGL 2: the object under light, its surroundings, a mirror sphere.

/** Return the numbers that a base64 text holds in little-endian order. */
function unpacked(text, Type) {
  const bytes = atob(text);
  const numbers = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; i += 1) numbers[i] = bytes.charCodeAt(i);
  return new Type(numbers.buffer);
}

class Renderer {
  /** Prepare everything that stays: programs, the mesh's arrays, the map. */
  constructor(canvas, shaders, scene) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("this browser offers no WebGL 2, which the page draws with");
    this.gl = gl;
    this.canvas = canvas;
    this.scene = scene;
    this.surface = this.program(shaders.surfaceVertex, shaders.header + shaders.surfaceFragment);
    this.surroundings = this.program(
      shaders.surroundingsVertex, shaders.header + shaders.surroundingsFragment,
    );
    this.fillArrays();
    this.map = scene.map ? this.texture(scene.map) : null;
  }

  program(vertex, fragment) {
    const { gl } = this;
    const program = gl.createProgram();
    [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].forEach(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
        throw new Error(gl.getShaderInfoLog(shader));
      }
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      throw new Error(gl.getProgramInfoLog(program));
    }
    const at = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; i += 1) {
      const name = gl.getActiveUniform(program, i).name.replace("[0]", "");
      at[name] = gl.getUniformLocation(program, name);
    }
    return { program, at };
  }

  fillArrays() {
    const { gl, scene } = this;
    this.normals = unpacked(scene.normals, Int16Array);
    this.albedo = unpacked(scene.albedo, Uint16Array);
    this.count = this.normals.length / 3;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    this.attribute("position", unpacked(scene.positions, Float32Array), gl.FLOAT);
    this.attribute("normal", this.normals, gl.SHORT);
    this.attribute("albedo", this.albedo, gl.UNSIGNED_SHORT);
    this.carried = this.attribute("carried", new Float32Array(3 * this.count), gl.FLOAT);
    this.fine = this.triangles(scene.faces);
    this.coarse = scene.coarseFaces ? this.triangles(scene.coarseFaces) : this.fine;
    gl.bindVertexArray(null);
  }

  triangles(text) {
    const { gl } = this;
    const corners = unpacked(text, Uint32Array);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    return { buffer, count: corners.length };
  }

  /** Give every vertex three numbers; whole numbers are shares of the greatest. */
  attribute(name, values, type) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    const place = gl.getAttribLocation(this.surface.program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, type, type !== gl.FLOAT, 0, 0);
    return buffer;
  }

  /** Let vertices carry other numbers: three each. */
  carry(values) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.carried);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
  }

  texture({ width, height, texels }) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(
      gl.TEXTURE_2D, 0, gl.RGB9_E5, width, height, 0, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV,
      unpacked(texels, Uint32Array),
    );
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /** Draw a view into a part of the canvas, whose lower left corner is at `left`, `bottom`. */
  draw(view, width = this.canvas.width, height = this.canvas.height, left = 0, bottom = 0) {
    const { gl } = this;
    gl.viewport(left, bottom, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(left, bottom, width, height);
    gl.clearColor(...view.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.disable(gl.DEPTH_TEST);
    if (this.map && view.background) this.drawSurroundings(view, false, width / height);
    gl.enable(gl.DEPTH_TEST);
    this.drawSurface(view, width / height);
    gl.disable(gl.DEPTH_TEST);
    if (this.map && view.mirror) {
      const side = Math.round(0.22 * Math.min(width, height));
      const margin = Math.round(0.02 * Math.min(width, height));
      gl.viewport(margin, margin, side, side);
      this.drawSurroundings(view, true, 1);
    }
  }

  /** Wait until everything is drawn: the browser may only promise `gl.finish`. */
  finish() {
    const { gl } = this;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  drawSurface(view, aspect) {
    const { gl, scene } = this;
    const { program, at } = this.surface;
    const [wide, high] = scene.extent;
    // As `frame_orthographic`: the larger of width and height, each against the picture's own.
    const span = (scene.margin * Math.max(high, wide / aspect)) / view.zoom;
    gl.useProgram(program);
    gl.uniformMatrix3fv(at.object, true, view.object.flat());
    gl.uniform3fv(at.centre, scene.centre);
    gl.uniform2f(at.scale, 2 / (span * aspect), 2 / span);
    gl.uniform1f(at.radius, scene.radius);
    gl.uniformMatrix4fv(at.matrices, false, view.matrices.flat());
    // The inverse of a rotation is its transpose: as columns, its rows.
    gl.uniformMatrix3fv(at.towardsLight, false, view.light.flat());
    gl.uniform1i(at.source, view.source);
    gl.uniform1i(at.shown, view.shown);
    gl.uniform1i(at.painted, view.painted ? 1 : 0);
    gl.uniform1f(at.exposure, view.exposure);
    gl.uniform3fv(at.signedColours, scene.signedColours.flat());
    gl.uniform3fv(at.luminance, scene.luminance);
    const { buffer, count } = view.coarse ? this.coarse : this.fine;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  }

  drawSurroundings(view, mirror, aspect) {
    const { gl } = this;
    const { program, at } = this.surroundings;
    gl.useProgram(program);
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.uniformMatrix3fv(at.towardsLight, false, view.mapRotation.flat());
    gl.uniform1i(at.mirror, mirror ? 1 : 0);
    gl.uniform2f(at.halfView, aspect, 1); // 90 degrees from top to bottom
    gl.uniform1f(at.exposure, view.exposure);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
