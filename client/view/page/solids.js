// The primitives of objects as instances for the renderer (renderer.js, kSolidLayout).
const kSolidFloats = 12;
const kHalfSpace = 6;

/// Decides which primitives are small in a picture; the key changes with the result.
function viewOf(camera, size, mostPoint) {
  const { back, right, up } = camera.axes();
  const eye = camera.eye();
  const view = { back, right, up, eye, focal: focalPixels(camera, size), halfHeight: camera.halfHeight, halfWidth: camera.halfHeight * camera.aspect, mostPoint };
  view.key = [...back, ...right, ...eye, ...size, view.halfWidth].join();
  return view;
}

/// The primitives of objects that are all moving, or all static.
class SolidSet {
  /// Static boxes are always triangles: where faces coincide, these know which is in front (placed_at in the shaders).
  constructor(solids, isStill) {
    const boxes = solids.filter(({ kind }) => kind === 1);
    this.boxes = isStill ? new StillInstances(boxes) : new SizedInstances(boxes);
    this.balls = new SizedInstances(solids.filter(({ kind }) => kind === 0));
    this.round = new SizedInstances(solids.filter(({ kind }) => kind > 1));
  }

  send(renderer, to, anchor, view) {
    for (const of of ["boxes", "balls", "round"]) if (this[of].place(anchor, view)) renderer.fillSized(to[of], this[of]);
  }
}

/// Instances that are written once, all as large ones.
class StillInstances {
  constructor(solids) {
    this.solids = solids;
    this.all = this.large = solids.length;
    this.small = 0;
    this.data = new Float32Array(kSolidFloats * this.all);
  }
  /// Returns whether the data have changed.
  place(anchor) {
    if (this.isPlaced) return false;
    this.solids.forEach((solid, i) => writeInstance(solid, anchor, this.data, kSolidFloats * i));
    this.isPlaced = true;
    return true;
  }
}

/// Instances of primitives: large ones from the beginning of the data, small ones up to its end; invisible ones are in
/// between, where they are not drawn.
class SizedInstances {
  constructor(solids) {
    this.solids = solids;
    this.all = solids.length;
    this.reaches = Float64Array.from(solids, ({ kind, half }) => (kind === 0 ? half[0] : length(half)));
    this.data = new Float32Array(kSolidFloats * this.all);
    this.large = this.small = 0;
  }

  place(anchor, view) {
    this.large = this.small = 0;
    const spare = new Float32Array(kSolidFloats);
    for (let i = 0; i < this.all; ++i) {
      writeInstance(this.solids[i], anchor, spare, 0);
      const seen = seenAs(spare, this.reaches[i], anchor, view);
      if (seen === kUnseen) continue;
      const at = seen === kLarge ? this.large++ : this.all - ++this.small;
      this.data.set(spare, kSolidFloats * at);
    }
    return true;
  }
}

const kUnseen = 0;
const kSmall = 1;
const kLarge = 2;

/// How an instance of this reach about the position in the first three floats appears: not at all, small enough for a
/// point, or large. WebGL omits a point whose middle is outside of the picture.
function seenAs(data, reach, anchor, { eye, back, right, up, focal, halfWidth, halfHeight, mostPoint }) {
  const x = data[0] + anchor[0] - eye[0];
  const y = data[1] + anchor[1] - eye[1];
  const z = data[2] + anchor[2] - eye[2];
  const depth = -(x * back[0] + y * back[1] + z * back[2]);
  if (depth < -reach) return kUnseen;
  if (depth < 4 * reach) return kLarge;
  const across = Math.abs(x * right[0] + y * right[1] + z * right[2]) / depth;
  const along = Math.abs(x * up[0] + y * up[1] + z * up[2]) / depth;
  const wide = reach / depth;
  // A ball away from the middle of the picture looks larger by 1 + across^2 + along^2, and from near by up to 0.4.
  const grown = 1.4 * wide * (1 + across * across + along * along);
  if (across - grown > halfWidth || along - grown > halfHeight) return kUnseen;
  if (across > halfWidth || along > halfHeight) return kLarge;
  return 2 * focal * grown + 2 > mostPoint ? kLarge : kSmall;
}

/// Writes the floats of an instance, without allocation: ten thousand of them move in each picture.
function writeInstance({ object, kind, position, turn: b, half }, anchor, data, at) {
  const px = position[0];
  const py = position[1];
  const pz = position[2];
  const w = object.turn[0];
  const x = object.turn[1];
  const y = object.turn[2];
  const z = object.turn[3];
  const tx = 2 * (y * pz - z * py);
  const ty = 2 * (z * px - x * pz);
  const tz = 2 * (x * py - y * px);
  data[at] = object.position[0] - anchor[0] + px + w * tx + y * tz - z * ty;
  data[at + 1] = object.position[1] - anchor[1] + py + w * ty + z * tx - x * tz;
  data[at + 2] = object.position[2] - anchor[2] + pz + w * tz + x * ty - y * tx;
  data[at + 3] = w * b[0] - x * b[1] - y * b[2] - z * b[3];
  data[at + 4] = w * b[1] + x * b[0] + y * b[3] - z * b[2];
  data[at + 5] = w * b[2] - x * b[3] + y * b[0] + z * b[1];
  data[at + 6] = w * b[3] + x * b[2] - y * b[1] + z * b[0];
  data[at + 7] = half[0];
  data[at + 8] = half[1];
  data[at + 9] = half[2];
  data[at + 10] = kind;
  data[at + 11] = object.slot;
}

/// Half the size of the box around a solid, along the object's axes.
function reachOf({ turn, half }) {
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotate(turn, axis));
  return [0, 1, 2].map((part) => axes.reduce((sum, axis, i) => sum + Math.abs(axis[part]) * half[i], 0));
}

/// The box around a primitive, with z along its axis, and its kind; null for a kind without a box.
function solidOf(part, object, reach = 1) {
  const [kind, ...n] = part;
  const center = n.slice(0, 3);
  if (kind === 0) return { object, kind, position: center, turn: [1, 0, 0, 0], half: [n[3], n[3], n[3]] };
  if (kind === 1 || kind === 5) return { object, kind, position: center, turn: n.slice(3, 7), half: n.slice(7, 10) };
  if (kind === kHalfSpace) {
    // A half-space is drawn as a slab as wide as the rest of the scene, with its upper side in the plane.
    const thickness = reach * 1e-3;
    const normal = normalized(n.slice(3, 6));
    return { object, kind: 1, position: subtract(center, scale(normal, thickness)), turn: turnFromZ(normal), half: [3 * reach, 3 * reach, thickness] };
  }
  // Two ends and a radius; a cone's first end is its tip.
  const far = kind === 4 ? center : n.slice(3, 6);
  const near = kind === 4 ? n.slice(3, 6) : center;
  const along = subtract(far, near);
  const radius = n[6];
  const half = length(along) / 2 + (kind === 2 ? radius : 0);
  return { object, kind, position: scale(add(far, near), 0.5), turn: turnFromZ(along), half: [radius, radius, half] };
}
