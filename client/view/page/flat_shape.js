// Shapes as they travel with definitions: FlatBuffers of the table Shape in idl/scene.fbs.

/// A table: its members by their numbers.
class FlatTable {
  constructor(view, at) {
    this.view = view;
    this.at = at;
    this.members = at - view.getInt32(at, true);
  }
  /// Where a member is; 0: it has none.
  place(member) {
    const entry = 4 + 2 * member;
    const offset = entry < this.view.getUint16(this.members, true) ? this.view.getUint16(this.members + entry, true) : 0;
    return offset ? this.at + offset : 0;
  }
  follow(at) { return at + this.view.getUint32(at, true); }
  number(member) {
    const at = this.place(member);
    return at ? this.view.getFloat64(at, true) : 0;
  }
  whole(member, otherwise = 0) {
    const at = this.place(member);
    return at ? this.view.getInt32(at, true) : otherwise;
  }
  doubles(at, count) { return Array.from({ length: count }, (_, i) => this.view.getFloat64(at + 8 * i, true)); }
  /// {first, count} of a list of numbers or structs, or of offsets.
  list(member) {
    const at = this.place(member);
    if (!at) return { first: 0, count: 0 };
    const list = this.follow(at);
    return { first: list + 4, count: this.view.getUint32(list, true) };
  }
  /// Structs of so many doubles.
  structs(member, doubles) {
    const { first, count } = this.list(member);
    return Array.from({ length: count }, (_, i) => this.doubles(first + 8 * doubles * i, doubles));
  }
  tables(member) {
    const { first, count } = this.list(member);
    return Array.from({ length: count }, (_, i) => new FlatTable(this.view, this.follow(first + 4 * i)));
  }
  table(member) {
    const at = this.place(member);
    return at ? new FlatTable(this.view, this.follow(at)) : null;
  }
}

/// A shape as the page draws it: {parts (as in page_messages.hpp), meshes [surface], left_out (parts that it cannot draw)}.
function readShape(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const shape = new FlatTable(view, view.getUint32(0, true));
  const [scaleAt] = [shape.place(13)];
  const factor = scaleAt ? shape.doubles(scaleAt, 3) : [1, 1, 1];
  const scaled = (point) => point.map((part, axis) => part * factor[axis]);
  const ends = (n) => [...scaled(n.slice(0, 3)), ...scaled(n.slice(3, 6)), n[6] * factor[0]];
  const axes = shape.structs(4, 9);
  const parts = [
    ...shape.structs(0, 4).map((n) => [0, ...scaled(n.slice(0, 3)), n[3] * factor[0]]),
    ...shape.structs(1, 10).map((n, i) => [1, ...scaled(n.slice(0, 3)), ...(axes[i] ? turnOfAxes(axes[i]) : n.slice(3, 7)), ...scaled(n.slice(7, 10))]),
    ...shape.structs(2, 7).map((n) => [2, ...ends(n)]), ...shape.structs(5, 7).map((n) => [3, ...ends(n)]), ...shape.structs(6, 7).map((n) => [4, ...ends(n)]),
    ...shape.structs(7, 15).map((n) => [5, ...scaled(n.slice(0, 3)), ...turnOfAxes(n.slice(3, 12)), ...scaled(n.slice(12, 15))]),
    ...shape.structs(9, 6).map((n) => [6, ...scaled(n)]),
    ...shape.tables(11).flatMap((cloud) => pointsOf(cloud).map((point) => [0, ...scaled(point), cloud.number(1) * factor[0]])),
    ...shape.tables(12).flatMap((way) => pointsOf(way).map((point, i, all) => [2, ...scaled(all[Math.max(0, i - 1)]), ...scaled(point), way.number(1) * factor[0]]).slice(1)),
  ];
  const meshes = [shape.table(3), ...shape.tables(8)].filter(Boolean).map((mesh) => meshSurface(mesh, scaled)).filter(({ corners }) => corners.length > 0);
  const leftOut = [10, 14, 17].reduce((sum, member) => sum + (member === 10 ? (shape.place(10) ? 1 : 0) : shape.list(member).count), 0) + shape.list(8).count - (meshes.length - (meshes.length > shape.list(8).count ? 1 : 0));
  return { parts, meshes, left_out: Math.max(0, leftOut) };
}

function pointsOf(table) {
  const { first, count } = table.list(0);
  return Array.from({ length: Math.floor(count / 3) }, (_, i) => table.doubles(first + 24 * i, 3));
}

function meshSurface(mesh, scaled) {
  const vertices = pointsOf(mesh).map(scaled);
  const { first, count } = mesh.list(1);
  const corners = Uint32Array.from({ length: count }, (_, i) => mesh.view.getUint32(first + 4 * i, true));
  return surfaceOfMesh(vertices, corners);
}

/// The rotation whose columns are given; they are orthonormal.
function turnOfAxes([a, b, c, d, e, f, g, h, i]) {
  const candidates = [[1 + a + e + i, f - h, g - c, b - d], [f - h, 1 + a - e - i, b + d, g + c], [g - c, b + d, 1 - a + e - i, f + h], [b - d, g + c, f + h, 1 - a - e + i]];
  const turn = candidates.reduce((best, one, k) => (one[k] > best.size ? { size: one[k], one } : best), { size: -Infinity }).one;
  const norm = Math.hypot(...turn);
  return turn.map((part) => part / norm);
}
