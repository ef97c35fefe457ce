/// Draws a World with WebGL 2. The constructor throws where the browser has none.
class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, depth: false, powerPreference: "high-performance" });
    if (!gl) throw new Error("no WebGL 2");
    this.canvas = canvas;
    this.gl = gl;
    this.sharpness = 1;  // drawn pixels for each pixel of the screen; the browser scales the picture
    this.still = this.program(kStillVertex, kTriangleFragment);
    this.placed = this.program(kPlacedVertex, kTriangleFragment);
    this.solid = this.program(kSolidVertex, kSolidFragment);
    this.ink = this.program(kWholeVertex, kInkFragment);
    this.mark = this.program(kMarkVertex, kMarkFragment);
    this.nothing = gl.createVertexArray();
    this.box = this.buffer(gl.ARRAY_BUFFER, boxCorners());
    this.quad = this.buffer(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    this.solids = this.instances([[1, 3], [2, 4], [3, 3], [4, 2]], this.box, 3);
    this.marks = this.instances([[1, 3], [2, 3], [3, 4]], this.quad, 2);
    this.states = this.texture(gl.R8UI, 1024, 1, gl.RED_INTEGER, gl.UNSIGNED_BYTE, null);
    this.stateRows = 1;
    this.size = [0, 0];
    this.meshes = [];
    this.readTheme();
  }

  program(vertex, fragment) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; ++i) {
      const { name } = gl.getActiveUniform(program, i);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  buffer(kind, data) {
    const gl = this.gl;
    const buffer = gl.createBuffer();
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    return buffer;
  }

  texture(format, width, height, layout, type, data) {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, layout, type, data);
    for (const parameter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, parameter, gl.NEAREST);
    for (const parameter of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, parameter, gl.CLAMP_TO_EDGE);
    return texture;
  }

  /// A buffer with the floats of one instance after the other; `layout` has [location, floats] for each attribute.
  instances(layout, corners, cornerFloats) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, corners);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, cornerFloats, gl.FLOAT, false, 0, 0);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const floats = this.attributes(layout);
    gl.bindVertexArray(null);
    return { array, buffer, floats, count: 0, room: 0 };
  }

  attributes(layout) {
    const gl = this.gl;
    const floats = layout.reduce((sum, [, size]) => sum + size, 0);
    let at = 0;
    for (const [place, size] of layout) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, floats * 4, at * 4);
      gl.vertexAttribDivisor(place, 1);
      at += size;
    }
    return floats;
  }

  fill(instances, data, count) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, instances.buffer);
    if (data.length > instances.room) {
      instances.room = data.length;
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    } else {
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, data.subarray(0, count * instances.floats));
    }
    instances.count = count;
  }

  /// Adds triangles: positions (3 floats each) and corners. With `slots`, one for each vertex, they do not move; else
  /// they are drawn at the poses that place() gives.
  addMesh(origin, positions, corners, slots) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [this.buffer(gl.ARRAY_BUFFER, positions)];
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    const mesh = { origin, array, buffers, corners: corners.length, stands: Boolean(slots), count: 0, room: 0, floats: 8 };
    if (slots) {
      buffers.push(this.buffer(gl.ARRAY_BUFFER, slots));
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 1, gl.FLOAT, false, 0, 0);
    } else {
      mesh.buffer = gl.createBuffer();
      buffers.push(mesh.buffer);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
      this.attributes([[1, 3], [2, 4], [3, 1]]);
    }
    buffers.push(this.buffer(gl.ELEMENT_ARRAY_BUFFER, corners));
    gl.bindVertexArray(null);
    this.meshes.push(mesh);
    return mesh;
  }

  removeMesh(mesh) {
    for (const buffer of mesh.buffers) this.gl.deleteBuffer(buffer);
    this.gl.deleteVertexArray(mesh.array);
    this.meshes.splice(this.meshes.indexOf(mesh), 1);
  }

  setStates(states) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const rows = states.length / 1024;
    if (rows !== this.stateRows) gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8UI, 1024, rows, 0, gl.RED_INTEGER, gl.UNSIGNED_BYTE, states);
    else gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 1024, rows, gl.RED_INTEGER, gl.UNSIGNED_BYTE, states);
    this.stateRows = rows;
  }

  readTheme() {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => {
      const text = style.getPropertyValue(name).trim();
      return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
    };
    this.theme = { paper: color("--paper"), ink: color("--ink"), accent: color("--accent") };
  }

  resize() {
    const gl = this.gl;
    this.pixels = (window.devicePixelRatio || 1) * this.sharpness;
    const size = [this.canvas.clientWidth, this.canvas.clientHeight].map((part) => Math.max(1, Math.min(4096, Math.round(part * this.pixels))));
    if (size[0] === this.size[0] && size[1] === this.size[1]) return;
    [this.canvas.width, this.canvas.height] = size;
    this.size = size;
    gl.deleteTexture(this.seen);
    gl.deleteRenderbuffer(this.depth);
    this.frame = this.frame || gl.createFramebuffer();
    this.seen = this.texture(gl.RGBA32UI, size[0], size[1], gl.RGBA_INTEGER, gl.UNSIGNED_INT, null);
    this.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, size[0], size[1]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.seen, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
  }

  use({ program, places }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    for (const [name, value] of Object.entries(values)) {
      const place = places[name];
      if (!place) continue;
      if (typeof value === "number") gl.uniform1f(place, value);
      else if (value.length === 2) gl.uniform2fv(place, value);
      else if (value.length === 3) gl.uniform3fv(place, value);
      else if (value.length === 4) gl.uniform4fv(place, value);
      else gl.uniformMatrix4fv(place, false, value);
    }
    return places;
  }

  /// near, far: range of depths; anchor: the point that positions of instances are relative to; ground: its height
  /// along `up`.
  draw(camera, { near, far, anchor, ground, grid }) {
    this.resize();
    const gl = this.gl;
    const eye = camera.eye();
    const matrix = camera.matrix(near, far);
    const anchorFromEye = subtract(anchor, eye);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.viewport(0, 0, this.size[0], this.size[1]);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
    for (const mesh of this.meshes) {
      if (!mesh.stands && mesh.count === 0) continue;
      gl.bindVertexArray(mesh.array);
      if (mesh.stands) {
        this.use(this.still, { u_matrix: matrix, u_from_eye: subtract(mesh.origin, eye) });
        gl.drawElements(gl.TRIANGLES, mesh.corners, gl.UNSIGNED_INT, 0);
      } else {
        this.use(this.placed, { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_origin: mesh.origin });
        gl.drawElementsInstanced(gl.TRIANGLES, mesh.corners, gl.UNSIGNED_INT, 0, mesh.count);
      }
    }
    if (this.solids.count > 0) {
      gl.enable(gl.CULL_FACE);
      gl.cullFace(gl.FRONT);
      this.use(this.solid, { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_depth_range: [near, far] });
      gl.bindVertexArray(this.solids.array);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 36, this.solids.count);
      gl.disable(gl.CULL_FACE);
    }
    this.drawInk(camera, eye, matrix, anchorFromEye, ground, grid);
  }

  drawInk(camera, eye, matrix, anchorFromEye, ground, grid) {
    const gl = this.gl;
    const { back, right, up } = camera.axes();
    const { size } = this;
    const sky = camera.yIsUp ? [0, 1, 0] : [0, 0, 1];
    const { paper, ink, accent } = this.theme;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, size[0], size[1]);
    gl.disable(gl.DEPTH_TEST);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.seen);
    const places = this.use(this.ink, {
      u_size: size, u_paper: paper, u_ink: ink, u_accent: accent,
      u_light: normalized(add(back, add(scale(up, 0.8), scale(right, -0.5)))),
      u_back: back, u_right: scale(right, camera.halfHeight * camera.aspect), u_up: scale(up, camera.halfHeight),
      u_ground: [...sky, dot(eye, sky) - ground],
      u_grid_eye: eye.map((part) => part - Math.floor(part / grid) * grid), u_grid: grid,
    });
    gl.uniform1i(places.u_seen, 0);
    gl.uniform1i(places.u_states, 1);
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    if (this.marks.count === 0) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const markPlaces = this.use(this.mark, { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_size: size, u_pixels: this.pixels, u_ink: ink, u_accent: accent });
    gl.uniform1i(markPlaces.u_seen, 0);
    gl.bindVertexArray(this.marks.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.marks.count);
  }

  /// The object at a point of the picture (fractions of its width and height, from the lower left): slot and distance,
  /// or null.
  pick(x, y) {
    const gl = this.gl;
    const numbers = new Uint32Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.readPixels(Math.floor(x * this.size[0]), Math.floor(y * this.size[1]), 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, numbers);
    if (numbers[0] === 0) return null;
    return { slot: numbers[0] - 1, range: new Float32Array(numbers.buffer, 4, 1)[0] };
  }
}

/// 12 triangles, counter-clockwise from outside.
function boxCorners() {
  const corners = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const side of [-1, 1]) {
      const u = (axis + 1) % 3;
      const v = (axis + 2) % 3;
      const square = [[-1, -1], [side, -side], [1, 1], [-1, -1], [1, 1], [-side, side]];
      for (const [a, b] of square) {
        const corner = [0, 0, 0];
        corner[axis] = side;
        corner[u] = a;
        corner[v] = b;
        corners.push(...corner);
      }
    }
  }
  return new Float32Array(corners);
}
