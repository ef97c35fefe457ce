// Vectors are arrays of 3 numbers, quaternions [w, x, y, z]; all in doubles. Values for the graphics card are relative
// to a nearby point, so that its floats are precise a million metres from the origin too.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const normalized = (a) => scale(a, 1 / (length(a) || 1));

function rotate(q, v) {
  const [w, x, y, z] = q;
  const tx = 2 * (y * v[2] - z * v[1]);
  const ty = 2 * (z * v[0] - x * v[2]);
  const tz = 2 * (x * v[1] - y * v[0]);
  return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}

/// The smallest rotation that turns z to the direction.
function turnFromZ(direction) {
  const d = normalized(direction);
  if (d[2] < -0.999999999) return [0, 1, 0, 0];
  const q = [1 + d[2], -d[1], d[0], 0];
  const norm = Math.hypot(...q);
  return q.map((part) => part / norm);
}

/// A bounding box that grows.
class Bounds {
  constructor() {
    this.low = [Infinity, Infinity, Infinity];
    this.high = [-Infinity, -Infinity, -Infinity];
  }
  extend(point, radius = 0) {
    for (let axis = 0; axis < 3; ++axis) {
      if (!Number.isFinite(point[axis])) return;
      this.low[axis] = Math.min(this.low[axis], point[axis] - radius);
      this.high[axis] = Math.max(this.high[axis], point[axis] + radius);
    }
  }
  corners() {
    const [low, high] = this.isEmpty() ? [[-1, -1, -1], [1, 1, 1]] : [this.low, this.high];
    return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((axis) => (i & (1 << axis) ? high : low)[axis]));
  }
  isEmpty() { return !(this.low[0] <= this.high[0]); }
  center() { return this.isEmpty() ? [0, 0, 0] : scale(add(this.low, this.high), 0.5); }
  radius() { return this.isEmpty() ? 1 : Math.max(1e-6, length(subtract(this.high, this.low)) / 2); }
}
