/// A camera that turns about a point.
class Camera {
  constructor() {
    this.target = [0, 0, 0];
    this.distance = 10;
    this.yaw = -0.9;
    this.pitch = 0.7;
    this.yIsUp = false;
    this.halfHeight = Math.tan((45 / 2) * (Math.PI / 180));  // half the picture's height at distance 1
    this.aspect = 1;
    this.isTouched = false;  // the user has moved it, so it is no longer fitted to the world
  }

  /// Unit vectors: towards the eye, right, up.
  axes() {
    const c = Math.cos(this.pitch);
    const back = this.fromUp([c * Math.cos(this.yaw), c * Math.sin(this.yaw), Math.sin(this.pitch)]);
    const right = this.fromUp([-Math.sin(this.yaw), Math.cos(this.yaw), 0]);
    return { back, right, up: cross(back, right) };
  }
  fromUp(v) { return this.yIsUp ? [v[0], v[2], -v[1]] : v; }
  eye() { return add(this.target, scale(this.axes().back, this.distance)); }

  turn(dx, dy) {
    this.isTouched = true;
    this.yaw -= dx;
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch + dy));
  }
  /// dx, dy: fractions of the picture's height.
  slide(dx, dy) {
    this.isTouched = true;
    const { right, up } = this.axes();
    const size = 2 * this.halfHeight * this.distance;
    this.target = add(this.target, add(scale(right, -dx * size), scale(up, dy * size)));
  }
  approach(factor) {
    this.isTouched = true;
    this.distance = Math.max(1e-4, Math.min(1e9, this.distance * factor));
  }
  /// Moves so that the whole box is in the picture, in the middle of the free part, with some room around it. above,
  /// below: covered parts of the picture's height.
  fit(bounds, above = 0, below = 0) {
    const free = Math.max(0.3, 1 - above - below);
    const { back, right, up } = this.axes();
    const corners = bounds.corners();
    this.target = bounds.center();
    const extent = (axis) => corners.map((corner) => dot(subtract(corner, this.target), axis));
    // The distance that the eye must keep so that a corner is within the picture's half width or height.
    const away = (across, half) => Math.max(...corners.map((corner, i) => Math.abs(across[i]) / half + dot(subtract(corner, this.target), back)));
    const room = 1.06;
    for (let round = 0; round < 4; ++round) {
      const [x, y] = [extent(right), extent(up)];
      this.distance = Math.max(1e-4, room * Math.max(away(x, this.halfHeight * this.aspect), away(y, this.halfHeight * free)));
      // Perspective shows the nearer half larger: centres the visible image, not the box.
      const seen = corners.map((corner) => this.project(corner)).filter(Boolean);
      const middle = (axis) => (Math.max(...seen.map((at) => at[axis])) + Math.min(...seen.map((at) => at[axis]))) / 2;
      const size = this.halfHeight * this.distance;
      this.target = add(this.target, add(scale(right, middle(0) * size * this.aspect), scale(up, (middle(1) - below + above) * size)));
    }
    this.turnAbout(bounds.center());
  }

  /// Keeps the eye and its target direction, and turns from now on about the target at the point's height.
  turnAbout(point) {
    const { back } = this.axes();
    const axis = this.yIsUp ? 1 : 2;
    const least = 0.1;  // for a flat view that is too far away
    const along = (this.target[axis] - point[axis]) / back[axis];
    if (Math.abs(back[axis]) < least || this.distance + along <= 0) return;
    this.target = subtract(this.target, scale(back, along));
    this.distance += along;
  }

  /// The direction through a point of the picture; x and y from -1 to 1, y up. Its component along the view is 1.
  direction(x, y) {
    const { back, right, up } = this.axes();
    return add(scale(back, -1), add(scale(right, x * this.halfHeight * this.aspect), scale(up, y * this.halfHeight)));
  }

  /// The image of a point, x and y from -1 to 1; null if it is behind the eye.
  project(point) {
    const { back, right, up } = this.axes();
    const p = subtract(point, this.eye());
    const depth = -dot(p, back);
    if (depth <= 0) return null;
    return [dot(p, right) / (depth * this.halfHeight * this.aspect), dot(p, up) / (depth * this.halfHeight), depth];
  }

  /// The projection matrix, column-major, for points relative to the eye.
  matrix(near, far) {
    const { back, right, up } = this.axes();
    const sx = 1 / (this.halfHeight * this.aspect);
    const sy = 1 / this.halfHeight;
    const sz = -(far + near) / (far - near);
    const tz = (-2 * far * near) / (far - near);
    const m = new Float32Array(16);
    for (let axis = 0; axis < 3; ++axis) {
      m[axis * 4] = right[axis] * sx;
      m[axis * 4 + 1] = up[axis] * sy;
      m[axis * 4 + 2] = back[axis] * sz;
      m[axis * 4 + 3] = -back[axis];
    }
    m[14] = tz;
    return m;
  }
}
