// Bits of an object's state, as the shaders read them.
const kMoves = 1;
const kInContact = 2;
const kUnderPointer = 4;
const kChosen = 8;
const kStale = 16;
const kHidden = 32;
const kInDoubt = 64;
const kFaint = 128;
const kLevelShift = 8;
const kLevelBits = 15 << kLevelShift;
const kOpen = 1 << 12;
const kOpenInsideOut = 1 << 13;
const kPlacedFloats = 8;

/// The server's objects, as drawn by the renderer. Without a renderer it only keeps the objects.
class World {
  constructor(renderer) {
    this.renderer = renderer;
    this.objects = new Map();  // by slot
    this.byName = new Map();
    this.movers = [];
    this.shells = [];
    this.bounds = new Bounds();
    this.anchor = [0, 0, 0];
    this.states = new Uint16Array(1024);
    this.tints = new Uint8Array(4 * 1024);
    this.tableVersion = null;
    this.version = 0;       // of the table as it is shown
    this.stillVersion = 0;  // changes with the static parts of the picture
    this.solids = { still: new SolidSet([], true), moving: new SolidSet([], false) };
    this.placedMeshes = [];  // {mesh, objects, data}
    this.worldTime = 0;
  }

  /// table: the answer to /objects; surfaceOf: the answers to /surface, by number.
  setTable(table, surfaceOf) {
    this.tableVersion = table.table_version;
    ++this.version;
    const before = this.objects;
    this.objects = new Map();
    this.byName = new Map();
    let slots = 1;
    for (const object of table.objects) {
      const [x, y, z, ...turn] = object.pose;
      object.position = [x, y, z];
      object.turn = turn;
      object.isThere = !object.moving && turn[0] === 1 && x === 0 && y === 0 && z === 0;
      const known = before.get(object.slot);
      if (known && known.name === object.name) {
        object.isHidden = known.isHidden;
        object.publisher = known.publisher;
        object.movedAt = known.movedAt;
        // A frame that is newer than the table may have arrived already.
        if (known.frame > table.version) {
          object.position = known.position;
          object.turn = known.turn;
        }
      }
      this.objects.set(object.slot, object);
      this.byName.set(object.name, object);
      slots = Math.max(slots, object.slot + 1);
    }
    this.states = new Uint16Array(1024 * Math.ceil(slots / 1024));
    this.tints = new Uint8Array(4 * this.states.length);
    this.measure(table, surfaceOf);
    for (const object of table.objects)
      this.states[object.slot] = (object.moving ? kMoves : 0) | (object.stale ? kStale : 0) | (object.isHidden ? kHidden : 0);
    this.stillLevels = levels(table.objects);
    this.stillRound = table.objects.filter(({ moving }) => !moving).flatMap(roundSurfaces);
    for (const [slot, level] of this.stillLevels) this.states[slot] |= level << kLevelShift;
    this.levelMovers();
    if (!this.renderer) return;
    this.renderer.setStates(this.states);
    this.renderer.setTints(this.tints);
    this.buildMeshes(table, surfaceOf);
    this.buildSolids(table);
    this.arePlacesNew = true;
    ++this.stillVersion;
  }

  /// The bounds of each object in its frame and of all in the world.
  measure(table, surfaceOf) {
    this.bounds = new Bounds();
    for (const object of table.objects) {
      const own = new Bounds();
      for (const [number, first, count] of object.runs) {
        const surface = surfaceOf(number);
        if (!surface) continue;
        const run = boundsOfRun(surface, first, count);
        own.extend(run.low);
        own.extend(run.high);
      }
      for (const part of object.parts) {
        const solid = solidOf(part, object);
        if (!solid || part[0] === kHalfSpace) continue;
        const reach = reachOf(solid);
        own.extend(add(solid.position, reach));
        own.extend(subtract(solid.position, reach));
      }
      object.own = own;
      object.shell = shellOf(object, surfaceOf);
      object.reach = own.isEmpty() ? 0 : Math.max(...own.corners().map(length));
      if (own.isEmpty()) continue;
      const placed = placedBounds(object);
      this.bounds.extend(placed.low);
      this.bounds.extend(placed.high);
    }
    this.movers = table.objects.filter(({ moving }) => moving);
    const mostShells = 64;  // each is compared with all moving objects
    this.shells = table.objects.filter(({ shell, moving }) => shell && !moving).sort((a, b) => b.own.radius() - a.own.radius()).slice(0, mostShells);
    this.anchor = this.bounds.center().map(Math.round);
  }

  buildMeshes(table, surfaceOf) {
    for (const mesh of [...this.renderer.meshes]) this.renderer.removeMesh(mesh);
    const still = new Map();   // surface: runs of fixed triangles
    const placed = new Map();  // "number first count moving": objects
    for (const object of table.objects) {
      for (const [number, first, count] of object.runs) {
        const surface = surfaceOf(number);
        if (!surface) continue;
        const map = object.isThere ? still : placed;
        const key = object.isThere ? surface : `${number} ${first} ${count} ${object.moving}`;
        if (!map.has(key)) map.set(key, { surface, first, count, runs: [], objects: [] });
        map.get(key).runs.push([object.slot, first, count]);
        map.get(key).objects.push(object);
      }
    }
    for (const { surface, runs } of still.values()) {
      const { positions, corners, slots } = separated(surface, runs);
      this.renderer.addMesh(surface.origin, positions, corners, slots, true);
    }
    this.placedMeshes = [];
    for (const { surface, first, count, objects } of placed.values()) {
      const mesh = this.renderer.addMesh(surface.origin, surface.positions, surface.corners.slice(3 * first, 3 * (first + count)), null, !objects[0].moving);
      this.placedMeshes.push({ mesh, objects, data: new Float32Array(kPlacedFloats * objects.length) });
    }
  }

  buildSolids(table) {
    const solids = { still: [], moving: [] };
    for (const object of table.objects) {
      for (const part of object.parts) {
        const solid = solidOf(part, object, this.bounds.radius());
        if (solid) solids[object.moving ? "moving" : "still"].push(solid);
      }
    }
    this.solids = { still: new SolidSet(solids.still, true), moving: new SolidSet(solids.moving, false) };
    for (const { mesh, objects, data } of this.placedMeshes) if (!objects[0].moving) this.placeMesh(mesh, objects, data);
  }

  /// Sets the poses of a frame (source.js).
  setPoses(frame) {
    const { count, origin, numbers, slots, stale } = frame;
    this.worldTime = frame.worldTime;
    for (let i = 0; i < count; ++i) {
      const object = this.objects.get(slots[i]);
      if (!object || !object.moving) continue;
      const at = 7 * i;
      const { position, turn } = object;
      let isElsewhere = false;
      for (let axis = 0; axis < 3; ++axis) {
        const value = origin[axis] + numbers[at + axis];
        // The origin may have changed, and floats about it are rounded otherwise.
        isElsewhere ||= Math.abs(position[axis] - value) > 1e-6 * Math.abs(numbers[at + axis]);
        position[axis] = value;
      }
      for (let part = 0; part < 4; ++part) {
        isElsewhere ||= turn[part] !== numbers[at + 3 + part];
        turn[part] = numbers[at + 3 + part];
      }
      // Also if the page goes back in time.
      if (isElsewhere || object.movedAt > frame.worldTime) object.movedAt = frame.worldTime;
      object.frame = frame.version;
      if (Boolean(this.states[object.slot] & kStale) !== Boolean(stale[i])) this.setState(object.slot, kStale, Boolean(stale[i]));
    }
    this.arePlacesNew = true;
  }

  /// Sends changes since the last picture: poses of moving objects and, with another view, which are small in it. size:
  /// of the first pass, in pixels.
  send(camera, size) {
    const { renderer } = this;
    const view = viewOf(camera, size, renderer.mostPoint);
    const isOtherView = view.key !== this.viewKey;
    if (isOtherView || this.sentVersion !== this.version) this.solids.still.send(renderer, renderer.stillSolids, this.anchor, view);
    if (isOtherView || this.arePlacesNew) this.solids.moving.send(renderer, renderer.movingSolids, this.anchor, view);
    if (this.arePlacesNew) for (const { mesh, objects, data } of this.placedMeshes) if (objects[0].moving) this.placeMesh(mesh, objects, data);
    this.viewKey = view.key;
    this.sentVersion = this.version;
    this.arePlacesNew = false;
    this.sendStates();
  }

  placeMesh(mesh, objects, data) {
    objects.forEach((object, i) => {
      data.set(subtract(object.position, this.anchor), kPlacedFloats * i);
      data.set(object.turn, kPlacedFloats * i + 3);
      data[kPlacedFloats * i + 7] = object.slot;
    });
    this.renderer.fill(mesh, data, objects.length);
  }

  /// Opens objects that enclose a moving one towards the eye, so that one can look into them.
  openShells() {
    const { movers } = this;
    for (const object of this.shells) {
      const holds = movers.some((mover) => mover !== object && isWithin(object, mover));
      this.setState(object.slot, object.shell === 1 ? kOpen : kOpenInsideOut, holds);
    }
  }

  /// Gives different levels to moving objects that coincide with others, as the parts of an arm do at its joints.
  levelMovers() {
    const levelOf = roundLevels(this.movers.flatMap(roundSurfaces), this.stillLevels, this.stillRound);
    for (const { slot } of this.movers) this.changeState(slot, (this.states[slot] & ~kLevelBits) | ((levelOf.get(slot) ?? 0) << kLevelShift));
  }

  setState(slot, bit, on) {
    if (slot === null || slot === undefined || slot >= this.states.length) return;
    this.changeState(slot, on ? this.states[slot] | bit : this.states[slot] & ~bit, bit);
  }
  changeState(slot, state, bit = 0) {
    if (state === this.states[slot]) return;
    this.states[slot] = state;
    this.statesChanged = true;
    if (!(state & kMoves)) this.stillStatesChanged = true;
    if (bit & (kHidden | kOpen | kOpenInsideOut) && !(state & kMoves)) ++this.stillVersion;
  }
  hasState(slot, bit) { return Boolean(this.states[slot] & bit); }
  sendStates() {
    if (this.statesChanged) this.renderer.setStates(this.states);
    this.statesChanged = this.stillStatesChanged = false;
  }

  /// The region of the picture in which things may have moved: from 0 to 1, grown by growX and growY; null if it is
  /// unknown.
  movingRegion(camera, growX, growY) {
    const region = [1, 1, 0, 0];
    const { back, right, up } = camera.axes();
    const eye = camera.eye();
    // Same as Camera.project, for ten thousand in each picture.
    for (const { position, reach } of this.movers) {
      const x = position[0] - eye[0];
      const y = position[1] - eye[1];
      const z = position[2] - eye[2];
      const depth = -(x * back[0] + y * back[1] + z * back[2]);
      if (depth < 2 * reach) return null;
      const half = 2 * depth * camera.halfHeight;
      const tall = (1.5 * reach) / half;
      const across = 0.5 + (x * right[0] + y * right[1] + z * right[2]) / (half * camera.aspect);
      extendRegion(region, across, 0.5 + (x * up[0] + y * up[1] + z * up[2]) / half, tall / camera.aspect + growX, tall + growY);
    }
    return region;
  }

  /// colorOf(object): [red, green, blue, how much], 0 to 255; null for none.
  tint(colorOf) {
    const before = this.tints.slice();
    this.tints.fill(0);
    if (colorOf) for (const object of this.objects.values()) this.tints.set(colorOf(object), 4 * object.slot);
    if (this.tints.every((part, i) => part === before[i])) return;
    if (this.renderer) this.renderer.setTints(this.tints);
    this.statesChanged = this.stillStatesChanged = true;
  }
}

function extendRegion(region, x, y, reachX, reachY) {
  region[0] = Math.max(0, Math.min(region[0], x - reachX));
  region[1] = Math.max(0, Math.min(region[1], y - reachY));
  region[2] = Math.min(1, Math.max(region[2], x + reachX));
  region[3] = Math.min(1, Math.max(region[3], y + reachY));
}

/// Whether an object is a room that others may be in: 1 for a box or a closed mesh that fills most of its bounds, 2 for
/// one whose triangles are inside out, 0 for all others.
function shellOf(object, surfaceOf) {
  if (object.parts.length === 1 && object.runs.length === 0) return object.parts[0][0] === 1 ? 1 : 0;
  if (object.parts.length > 0 || object.runs.length !== 1 || object.own.isEmpty()) return 0;
  const [number, first, count] = object.runs[0];
  const surface = surfaceOf(number);
  const mostTriangles = 1000;
  if (!surface || count > mostTriangles) return 0;
  const corner = (i) => [...surface.positions.subarray(3 * surface.corners[i], 3 * surface.corners[i] + 3)];
  let volume = 0;
  for (let i = 3 * first; i < 3 * (first + count); i += 3) volume += dot(corner(i), cross(corner(i + 1), corner(i + 2))) / 6;
  const [x, y, z] = subtract(object.own.high, object.own.low);
  return Math.abs(volume) < 0.4 * x * y * z ? 0 : volume > 0 ? 1 : 2;
}

/// Whether a mover's middle is in the bounds of a larger object.
function isWithin(object, mover) {
  if (mover.own.isEmpty() || mover.own.radius() > object.own.radius()) return false;
  const [w, x, y, z] = object.turn;
  const local = rotate([w, -x, -y, -z], subtract(mover.position, object.position));
  return [0, 1, 2].every((axis) => local[axis] > object.own.low[axis] && local[axis] < object.own.high[axis]);
}

/// Whether the server tests two objects against each other: by their layers and masks, groups, and whether one of them
/// moves.
function mayMeet(a, b) {
  return (a.moving || b.moving) && (a.layers & b.mask) !== 0 && (b.layers & a.mask) !== 0 && !(a.group !== 0 && a.group === b.group);
}

/// The bounds of an object at its pose; those of a turned one may be too wide.
function placedBounds(object) {
  const placed = new Bounds();
  for (const corner of object.own.corners()) placed.extend(add(object.position, rotate(object.turn, corner)));
  return placed;
}

/// The vertices of runs, copied where runs of several objects share them, so that each vertex belongs to one object.
function separated(surface, runs) {
  const corners = new Uint32Array(runs.reduce((sum, [, , count]) => sum + 3 * count, 0));
  const newNumber = new Uint32Array(surface.positions.length / 3);
  const seenIn = new Int32Array(newNumber.length).fill(-1);
  const old = [];
  const slots = [];
  let at = 0;
  runs.forEach(([slot, first, count], run) => {
    for (let i = 3 * first; i < 3 * (first + count); ++i) {
      const vertex = surface.corners[i];
      if (seenIn[vertex] !== run) {
        seenIn[vertex] = run;
        newNumber[vertex] = old.length;
        old.push(vertex);
        slots.push(slot);
      }
      corners[at++] = newNumber[vertex];
    }
  });
  const positions = new Float32Array(3 * old.length);
  old.forEach((vertex, i) => positions.set(surface.positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  return { positions, corners, slots: new Float32Array(slots) };
}
