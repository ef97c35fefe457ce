const kMoves = 1;
const kInContact = 2;
const kUnderPointer = 4;
const kChosen = 8;
const kStale = 16;
const kSolidFloats = 12;
const kPlacedFloats = 8;

/// The server's objects, as what the renderer draws. Without a renderer it only keeps the objects.
class World {
  constructor(renderer) {
    this.renderer = renderer;
    this.objects = new Map();  // by slot
    this.byName = new Map();
    this.bounds = new Bounds();
    this.anchor = [0, 0, 0];
    this.states = new Uint8Array(1024);
    this.tableVersion = null;
    this.solids = [];       // {object, kind, position, turn, half}; those that do not move come first
    this.stillSolids = 0;
    this.solidData = new Float32Array(0);
    this.placedMeshes = [];  // {mesh, objects}
    this.worldTime = 0;
  }

  /// table: the answer to /objects; surfaceOf: the answers to /surface, by number.
  setTable(table, surfaceOf) {
    this.tableVersion = table.table_version;
    const before = this.objects;
    this.objects = new Map();
    this.byName = new Map();
    let slots = 1;
    for (const object of table.objects) {
      const [x, y, z, ...turn] = object.pose;
      object.position = [x, y, z];
      object.turn = turn;
      object.isThere = !object.moving && turn[0] === 1 && x === 0 && y === 0 && z === 0;
      // A frame that is newer than the table may have come already.
      const known = before.get(object.slot);
      if (known && known.name === object.name && known.frame > table.version) {
        object.position = known.position;
        object.turn = known.turn;
      }
      this.objects.set(object.slot, object);
      this.byName.set(object.name, object);
      slots = Math.max(slots, object.slot + 1);
    }
    this.states = new Uint8Array(1024 * Math.ceil(slots / 1024));
    for (const object of table.objects) this.states[object.slot] = (object.moving ? kMoves : 0) | (object.stale ? kStale : 0);
    this.measure(table, surfaceOf);
    if (!this.renderer) return;
    this.renderer.setStates(this.states);
    this.buildMeshes(table, surfaceOf);
    this.buildSolids(table);
    this.place();
  }

  measure(table, surfaceOf) {
    this.bounds = new Bounds();
    const surfaces = new Set();
    for (const object of table.objects) {
      for (const [number] of object.runs) {
        const surface = surfaceOf(number);
        if (!surface) continue;
        if (object.isThere) surfaces.add(surface);
        else this.bounds.extend(add(object.position, rotate(object.turn, surface.origin)), surface.radius);
      }
      for (const part of object.parts) {
        const solid = solidOf(part, object);
        if (solid && part[0] !== 6) this.bounds.extend(add(object.position, rotate(object.turn, solid.position)), Math.max(...solid.half));
      }
    }
    for (const surface of surfaces) {
      this.bounds.extend(add(surface.origin, surface.low));
      this.bounds.extend(add(surface.origin, surface.high));
    }
    this.anchor = this.bounds.center().map(Math.round);
  }

  buildMeshes(table, surfaceOf) {
    for (const mesh of [...this.renderer.meshes]) this.renderer.removeMesh(mesh);
    const still = new Map();   // surface: [[slot, first, count]]
    const placed = new Map();  // "number first count": objects
    for (const object of table.objects) {
      for (const [number, first, count] of object.runs) {
        const surface = surfaceOf(number);
        if (!surface) continue;
        const map = object.isThere ? still : placed;
        const key = object.isThere ? surface : `${number} ${first} ${count}`;
        if (!map.has(key)) map.set(key, { surface, first, count, runs: [], objects: [] });
        map.get(key).runs.push([object.slot, first, count]);
        map.get(key).objects.push(object);
      }
    }
    for (const { surface, runs } of still.values()) {
      const { positions, corners, slots } = separated(surface, runs);
      this.renderer.addMesh(surface.origin, positions, corners, slots);
    }
    this.placedMeshes = [];
    for (const { surface, first, count, objects } of placed.values()) {
      const mesh = this.renderer.addMesh(surface.origin, surface.positions, surface.corners.slice(3 * first, 3 * (first + count)), null);
      this.placedMeshes.push({ mesh, objects, data: new Float32Array(kPlacedFloats * objects.length) });
    }
  }

  buildSolids(table) {
    this.solids = [];
    for (const moving of [false, true]) {
      for (const object of table.objects) {
        if (object.moving !== moving) continue;
        for (const part of object.parts) {
          const solid = solidOf(part, object, this.bounds.radius());
          if (solid) this.solids.push(solid);
        }
      }
      if (!moving) this.stillSolids = this.solids.length;
    }
    this.solidData = new Float32Array(kSolidFloats * this.solids.length);
  }

  /// Sets the poses of a frame (source.js).
  setPoses(frame) {
    const { count, origin, numbers, slots, stale } = frame;
    this.worldTime = frame.worldTime;
    for (let i = 0; i < count; ++i) {
      const object = this.objects.get(slots[i]);
      if (!object || !object.moving) continue;
      const at = 7 * i;
      object.position = [origin[0] + numbers[at], origin[1] + numbers[at + 1], origin[2] + numbers[at + 2]];
      object.turn = [numbers[at + 3], numbers[at + 4], numbers[at + 5], numbers[at + 6]];
      object.frame = frame.version;
      if (Boolean(this.states[object.slot] & kStale) !== Boolean(stale[i])) this.setState(object.slot, kStale, Boolean(stale[i]));
    }
    this.place();
  }

  /// Moves the instances to where their objects are.
  place() {
    if (!this.renderer) return;
    const data = this.solidData;
    const anchor = this.anchor;
    for (let i = 0; i < this.solids.length; ++i) {
      const { object, kind, position, turn, half } = this.solids[i];
      const p = rotate(object.turn, position);
      const q = multiplied(object.turn, turn);
      const at = kSolidFloats * i;
      for (let axis = 0; axis < 3; ++axis) {
        data[at + axis] = object.position[axis] + p[axis] - anchor[axis];
        data[at + 7 + axis] = half[axis];
      }
      for (let part = 0; part < 4; ++part) data[at + 3 + part] = q[part];
      data[at + 10] = kind;
      data[at + 11] = object.slot;
    }
    this.renderer.fill(this.renderer.solids, data, this.solids.length);
    for (const { mesh, objects, data: places } of this.placedMeshes) {
      objects.forEach((object, i) => {
        places.set(subtract(object.position, anchor), kPlacedFloats * i);
        places.set(object.turn, kPlacedFloats * i + 3);
        places[kPlacedFloats * i + 7] = object.slot;
      });
      this.renderer.fill(mesh, places, objects.length);
    }
  }

  setState(slot, bit, on) {
    if (slot === null || slot === undefined || slot >= this.states.length) return;
    const state = on ? this.states[slot] | bit : this.states[slot] & ~bit;
    if (state === this.states[slot]) return;
    this.states[slot] = state;
    this.statesChanged = true;
  }
  sendStates() {
    if (this.statesChanged && this.renderer) this.renderer.setStates(this.states);
    this.statesChanged = false;
  }
}

/// The box around a primitive, with z along its axis, and its kind; null for a kind without a box.
function solidOf(part, object, reach = 1) {
  const [kind, ...n] = part;
  const center = n.slice(0, 3);
  if (kind === 0) return { object, kind, position: center, turn: [1, 0, 0, 0], half: [n[3], n[3], n[3]] };
  if (kind === 1 || kind === 5) return { object, kind, position: center, turn: n.slice(3, 7), half: n.slice(7, 10) };
  if (kind === 6) {
    // A half-space is drawn as a slab as wide as everything else, with its upper side in the plane.
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
