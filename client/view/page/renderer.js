const kSolidLayout = [[1, 3], [2, 4], [3, 3], [4, 2]];  // [location, floats]: position, turn, half size, kind and slot
const kMostPoint_px = 48;  // wider ones are drawn as a box: its corners cost less than the pixels beside the ball
const kPrograms = {
  standing: [kStillVertex, kTriangleFragment], placed: [kPlacedVertex, kTriangleFragment], box: [kBoxVertex, kBoxFragment],
  boxPoint: [kRoundPointVertex, kBoxPointFragment], ballPoint: [kBallPointVertex, kBallPointFragment], roundPoint: [kRoundPointVertex, kRoundFragment], roundBox: [kRoundBoxVertex, kRoundFragment],
  ink: [kWholeVertex, kInkFragment], mark: [kMarkVertex, kMarkFragment],
};
const focalPixels = (camera, [, height]) => height / (2 * camera.halfHeight);

/// Draws a World with WebGL 2. The constructor throws if the browser has none.
class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, depth: true, preserveDrawingBuffer: true, powerPreference: "high-performance" });
    if (!gl) throw new Error("no WebGL 2");
    this.canvas = canvas;
    this.gl = gl;
    this.sharpness = 1;  // pixels of the first pass for each one of the screen; above 1 the whole picture has more
    this.parallel = gl.getExtension("KHR_parallel_shader_compile");
    this.sources = kPrograms;
    this.programs = {};  // those begun, by name: {program, places}; places only once it is ready
    this.mostPoint = Math.min(kMostPoint_px, gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE)[1]);
    this.nothing = gl.createVertexArray();
    this.corners = this.buffer(gl.ARRAY_BUFFER, boxStrip());
    this.quad = this.buffer(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
    const solids = () => ({ boxes: this.sizedInstances(), balls: this.sizedInstances(), round: this.sizedInstances() });
    this.stillSolids = solids();
    this.movingSolids = solids();
    this.marks = this.instances([[1, 3], [2, 3], [3, 4]], this.quad, 2);
    this.grid = this.instances([[1, 3], [2, 3], [3, 4]], this.quad, 2);
    this.states = this.texture(gl.R16UI, 1024, 1, gl.RED_INTEGER, gl.UNSIGNED_SHORT, null);
    this.tints = this.texture(gl.RGBA8, 1024, 1, gl.RGBA, gl.UNSIGNED_BYTE, null);
    this.stateRows = this.tintRows = 1;
    this.size = [0, 0];
    this.stillKey = "";
    this.meshes = [];
    this.readTheme();
  }

  /// Whether all shaders for the next picture are ready. They are made when there is something to draw with them, all
  /// at once and on another thread if the browser can. Throws if one is refused.
  prepare() {
    const { stillSolids, movingSolids } = this;
    const counts = (of) => [stillSolids[of], movingSolids[of]];
    const needed = {
      ink: true, mark: true,
      standing: this.meshes.some(({ stands }) => stands), placed: this.meshes.some(({ stands }) => !stands),
      box: counts("boxes").some(({ count }) => count > 0), boxPoint: counts("boxes").some(({ small }) => small > 0),
      ballPoint: counts("balls").some(({ small }) => small > 0), roundPoint: counts("round").some(({ small }) => small > 0),
      roundBox: [...counts("balls"), ...counts("round")].some(({ count }) => count > 0),
    };
    const names = Object.keys(needed).filter((name) => needed[name]);
    for (const name of names) this.programs[name] ||= this.begun(...kPrograms[name]);
    return names.every((name) => this.programs[name].places || this.finish(this.programs[name]));
  }

  begun(vertex, fragment) {
    const gl = this.gl;
    const program = gl.createProgram();
    const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      return shader;
    });
    gl.linkProgram(program);
    return { program, shaders, places: null };
  }

  /// Uses a program once it is complete; returns whether it is.
  finish(begun) {
    const gl = this.gl;
    const { program, shaders } = begun;
    if (gl.isContextLost() || (this.parallel && !gl.getProgramParameter(program, this.parallel.COMPLETION_STATUS_KHR))) return false;
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program) || shaders.map((shader) => gl.getShaderInfoLog(shader)).join(" "));
    const places = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; ++i) {
      const { name } = gl.getActiveUniform(program, i);
      places[name] = gl.getUniformLocation(program, name);
    }
    gl.useProgram(program);
    for (const [name, unit] of [["u_seen", 0], ["u_states", 1], ["u_tints", 2]]) if (places[name]) gl.uniform1i(places[name], unit);
    begun.places = places;
    return true;
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

  /// Instances of primitives: large ones first, as instances of a box, small ones last, as points.
  sizedInstances() {
    const gl = this.gl;
    const instances = this.instances(kSolidLayout, this.corners, 4);
    instances.points = gl.createVertexArray();
    gl.bindVertexArray(instances.points);
    gl.bindBuffer(gl.ARRAY_BUFFER, instances.buffer);
    this.attributes(kSolidLayout, 0);
    gl.bindVertexArray(null);
    return Object.assign(instances, { small: 0, all: 0 });
  }

  attributes(layout, divisor = 1) {
    const gl = this.gl;
    const floats = layout.reduce((sum, [, size]) => sum + size, 0);
    let at = 0;
    for (const [place, size] of layout) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, floats * 4, at * 4);
      gl.vertexAttribDivisor(place, divisor);
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

  /// data: of SizedInstances (solids.js)
  fillSized(instances, { data, all, large, small }) {
    this.fill(instances, data, all);
    Object.assign(instances, { all, count: large, small });
  }

  /// Adds triangles: positions (3 floats each) and corners. With `slots`, one for each vertex, they are fixed; else
  /// they are drawn at the poses given to place(). isStill: only a new table moves them.
  addMesh(origin, positions, corners, slots, isStill) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [this.buffer(gl.ARRAY_BUFFER, positions)];
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    const mesh = { origin, array, buffers, corners: corners.length, stands: Boolean(slots), isStill, count: 0, room: 0, floats: 8 };
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

  setStates(states) { this.stateRows = this.rows(this.states, this.stateRows, states, 1, this.gl.R16UI, this.gl.RED_INTEGER, this.gl.UNSIGNED_SHORT); }
  setTints(tints) { this.tintRows = this.rows(this.tints, this.tintRows, tints, 4, this.gl.RGBA8, this.gl.RGBA, this.gl.UNSIGNED_BYTE); }

  /// Sends rows of 1024 slots, each with `parts` parts; returns the texture's number of rows.
  rows(texture, before, data, parts, format, layout, type) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const rows = data.length / (1024 * parts);
    if (rows !== before) gl.texImage2D(gl.TEXTURE_2D, 0, format, 1024, rows, 0, layout, type, data);
    else gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 1024, rows, layout, type, data);
    return rows;
  }

  readTheme() {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => {
      const text = style.getPropertyValue(name).trim();
      return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
    };
    this.stillKey = "";  // the whole picture has other colors, not only the moving parts
    this.theme = { paper: color("--paper"), ink: color("--ink"), accent: color("--accent") };
  }

  /// Makes the picture as large as its place on the screen. The first pass uses a part of its textures, by its
  /// sharpness, so that another sharpness needs no new ones.
  resize() {
    const gl = this.gl;
    const ratio = window.devicePixelRatio || 1;
    const inFirstPass = Math.max(kCoarsest, Math.min(1, this.sharpness));
    this.pixels = Math.max(Math.min(1, ratio), ratio * Math.max(1, this.sharpness) * (Math.min(1, this.sharpness) / inFirstPass));
    const limit = Math.min(1, 4096 / (this.pixels * Math.max(1, this.canvas.clientWidth, this.canvas.clientHeight)));
    this.pixels *= limit;
    const size = [this.canvas.clientWidth, this.canvas.clientHeight].map((part) => Math.max(1, Math.round(part * this.pixels)));
    this.seenSize = size.map((part) => Math.max(1, Math.round(part * inFirstPass)));
    if (size[0] === this.size[0] && size[1] === this.size[1]) return;
    [this.canvas.width, this.canvas.height] = size;
    this.size = size;
    for (const frame of [this.whole, this.still]) this.release(frame);
    this.whole = this.firstPass(size);
    // Static objects are kept in a second texture, as long as its size fits into the graphics cards of phones.
    const most = 5e6;
    this.still = size[0] * size[1] <= most ? this.firstPass(size) : null;
    this.stillKey = "";
  }

  firstPass(size) {
    const gl = this.gl;
    const frame = { buffer: gl.createFramebuffer(), seen: this.texture(gl.RGBA32UI, size[0], size[1], gl.RGBA_INTEGER, gl.UNSIGNED_INT, null), depth: gl.createRenderbuffer() };
    gl.bindRenderbuffer(gl.RENDERBUFFER, frame.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, size[0], size[1]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame.buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, frame.seen, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, frame.depth);
    return frame;
  }
  release(frame) {
    if (!frame) return;
    this.gl.deleteTexture(frame.seen);
    this.gl.deleteRenderbuffer(frame.depth);
    this.gl.deleteFramebuffer(frame.buffer);
  }

  use(name, values) {
    const gl = this.gl;
    const { program, places } = this.programs[name];
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
  }

  /// near, far: range of depths; anchor: the origin of instances' positions; ground: its height along `up`;
  /// stillVersion: changes with the static objects; region: [low x, low y, high x, high y], from 0 to 1, outside of
  /// which nothing has changed, or null. Call resize() and prepare() before.
  draw(camera, { near, far, anchor, ground, grid, stillVersion, region }) {
    const gl = this.gl;
    const eye = camera.eye();
    const matrix = camera.matrix(near, far);
    const { back, right, up } = camera.axes();
    const rays = { u_seen_size: this.seenSize, u_forward: scale(back, -1), u_half_right: scale(right, camera.halfHeight * camera.aspect), u_half_up: scale(up, camera.halfHeight), u_depth_range: [near, far] };
    const scene = { matrix, eye, anchorFromEye: subtract(anchor, eye), rays, focal: focalPixels(camera, this.seenSize) };
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.states);
    gl.activeTexture(gl.TEXTURE0);
    gl.viewport(0, 0, this.seenSize[0], this.seenSize[1]);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    const key = [...matrix, ...eye, ...this.seenSize, stillVersion].join();
    const isWhole = !this.still || key !== this.stillKey || !region;
    if (!this.still || key !== this.stillKey) {
      this.begin(this.still || this.whole);
      this.drawPart(scene, true);
    }
    this.stillKey = key;
    if (!isWhole) this.limitTo(region, this.seenSize);
    if (this.still) this.copyStill();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.whole.buffer);
    this.drawPart(scene, false);
    if (!isWhole) this.limitTo(region, this.size);
    this.drawInk(camera, scene, ground, grid);
    gl.disable(gl.SCISSOR_TEST);
    this.drawnPart = isWhole ? 1 : (region[2] - region[0]) * (region[3] - region[1]);
  }

  /// After this nothing is drawn outside the region.
  limitTo(region, [width, height]) {
    const gl = this.gl;
    const [x, y] = [Math.floor(region[0] * width), Math.floor(region[1] * height)];
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(x, y, Math.max(0, Math.ceil(region[2] * width) - x), Math.max(0, Math.ceil(region[3] * height) - y));
  }

  begin(frame) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame.buffer);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
  }

  copyStill() {
    const gl = this.gl;
    const [width, height] = this.seenSize;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.still.buffer);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.whole.buffer);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT, gl.NEAREST);
  }

  /// Draws the static or the moving objects.
  drawPart({ matrix, eye, anchorFromEye, rays, focal }, isStill) {
    const gl = this.gl;
    gl.disable(gl.CULL_FACE);
    for (const mesh of this.meshes) {
      if (mesh.isStill !== isStill || (!mesh.stands && mesh.count === 0)) continue;
      gl.bindVertexArray(mesh.array);
      if (mesh.stands) {
        this.use("standing", { u_matrix: matrix, u_from_eye: subtract(mesh.origin, eye) });
        gl.drawElements(gl.TRIANGLES, mesh.corners, gl.UNSIGNED_INT, 0);
      } else {
        this.use("placed", { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_origin: mesh.origin });
        gl.drawElementsInstanced(gl.TRIANGLES, mesh.corners, gl.UNSIGNED_INT, 0, mesh.count);
      }
    }
    const { boxes, balls, round } = isStill ? this.stillSolids : this.movingSolids;
    const values = { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_focal: focal, ...rays };
    this.drawBoxes("box", boxes, values);
    this.drawPoints("boxPoint", boxes, values);
    this.drawPoints("ballPoint", balls, values);
    this.drawPoints("roundPoint", round, values);
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    this.drawBoxes("roundBox", balls, values);
    this.drawBoxes("roundBox", round, values);
    gl.disable(gl.CULL_FACE);
  }

  drawBoxes(program, { array, count }, values) {
    if (count === 0) return;
    this.use(program, values);
    this.gl.bindVertexArray(array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, 14, count);
  }

  drawPoints(program, { points, all, small }, values) {
    if (small === 0) return;
    this.use(program, values);
    this.gl.bindVertexArray(points);
    this.gl.drawArrays(this.gl.POINTS, all - small, small);
  }

  drawInk(camera, { matrix, eye, anchorFromEye }, ground, grid) {
    const gl = this.gl;
    const { back, right, up } = camera.axes();
    const { size, seenSize } = this;
    const { paper, ink, accent } = this.theme;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, size[0], size[1]);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, this.tints);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.whole.seen);
    const values = {
      u_size: size, u_seen_size: seenSize, u_pixels: this.pixels, u_paper: paper, u_ink: ink, u_accent: accent,
      u_light: normalized(add(back, add(scale(up, 0.8), scale(right, -0.5)))),
      u_pixel_angle: (2 * camera.halfHeight) / seenSize[1],
    };
    gl.bindVertexArray(this.nothing);
    this.use("ink", values);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const markValues = { u_matrix: matrix, u_anchor_from_eye: anchorFromEye, u_size: size, u_seen_scale: seenSize.map((part, axis) => part / size[axis]), u_pixels: this.pixels, u_ink: ink, u_accent: accent };
    this.placeGrid(camera, eye, add(eye, anchorFromEye), ground, grid);
    gl.depthMask(false);
    this.drawMarks(this.grid, markValues);
    gl.disable(gl.DEPTH_TEST);
    this.drawMarks(this.marks, markValues);
    gl.depthMask(true);
    gl.bindTexture(gl.TEXTURE_2D, null);
  }

  drawMarks(marks, values) {
    const gl = this.gl;
    if (marks.count === 0) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.use("mark", values);
    gl.bindVertexArray(marks.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, marks.count);
    gl.disable(gl.BLEND);
  }

  /// The lines of a square grid on the ground, around the camera's target.
  placeGrid(camera, eye, anchor, ground, grid) {
    const lines = 24;
    const [x, y, z] = camera.yIsUp ? [0, 2, 1] : [0, 1, 2];
    const middle = [x, y].map((axis) => Math.round(camera.target[axis] / grid));
    const key = [...middle, ...anchor, ground, grid, camera.yIsUp, Math.round(camera.distance / grid)].join();
    if (key === this.gridKey) return;
    this.gridKey = key;
    const reach = Math.min(lines * grid, camera.distance * 4);
    const data = new Float32Array(10 * 2 * (2 * lines + 1));
    let at = 0;
    for (const [across, along] of [[x, y], [y, x]]) {
      for (let i = -lines; i <= lines; ++i) {
        const from = [0, 0, 0];
        from[across] = (middle[across === x ? 0 : 1] + i) * grid - anchor[across];
        from[z] = ground - anchor[z];
        const to = [...from];
        from[along] = (middle[along === x ? 0 : 1] - lines) * grid - anchor[along];
        to[along] = (middle[along === x ? 0 : 1] + lines) * grid - anchor[along];
        data.set([...from, ...to, 1, 3, 0.18, reach], at);
        at += 10;
      }
    }
    this.fill(this.grid, data, data.length / 10);
  }

  /// The object at a point of the picture (fractions of its width and height, from the lower left): slot, distance,
  /// normal, and the middle of that pixel, or null.
  pick(x, y) {
    const gl = this.gl;
    if (!this.whole) return null;
    const numbers = new Uint32Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.whole.buffer);
    const [column, row] = [Math.floor(x * this.seenSize[0]), Math.floor(y * this.seenSize[1])];
    gl.readPixels(column, row, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, numbers);
    if (numbers[0] === 0) return null;
    const normal = [0, 1, 2].map((axis) => ((numbers[2] << (24 - 8 * axis)) >> 24) / 127);
    return { slot: numbers[0] - 1, range: new Float32Array(numbers.buffer, 4, 1)[0], normal: normalized(normal), middle: [(column + 0.5) / this.seenSize[0], (row + 0.5) / this.seenSize[1]] };
  }
}

/// A box as a strip of 12 triangles, counter-clockwise from outside: 14 corners, each with the number of the side that
/// its triangle, of which it is the last corner, lies in (2 * axis, one more for the upper one). Source: Evans, Skiena,
/// Varshney, "Optimizing triangle strips for fast rendering", 1996.
function boxStrip() {
  const bits = [0x287a, 0x02af, 0x31e3];
  const places = Array.from({ length: 14 }, (_, i) => bits.map((of) => ((of >> i) & 1 ? 1 : -1)));
  return new Float32Array(places.flatMap((place, i) => {
    const triangle = places.slice(Math.max(0, i - 2), i + 1);
    const axis = i < 2 ? 0 : [0, 1, 2].find((each) => triangle.every((corner) => corner[each] === place[each]));
    return [...place, 2 * axis + (place[axis] > 0 ? 1 : 0)];
  }));
}
