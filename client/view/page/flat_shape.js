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
  byte(member) {
    const at = this.place(member);
    return at ? this.view.getUint8(at) : 0;
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

/// A shape as the page draws it: {parts (as in page_messages.hpp), meshes [surface]}. scale: factors besides its own.
function readShape(bytes, scale = [1, 1, 1]) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const shape = new FlatTable(view, view.getUint32(0, true));
  const scaleAt = shape.place(13);
  const factor = (scaleAt ? shape.doubles(scaleAt, 3) : [1, 1, 1]).map((one, axis) => one * scale[axis]);
  const scaled = (point) => point.map((part, axis) => part * factor[axis]);
  const ends = (n) => [...scaled(n.slice(0, 3)), ...scaled(n.slice(3, 6)), n[6] * factor[0]];
  const axes = shape.structs(4, 9);
  const ball = (center, radius) => [0, ...scaled(center), radius * factor[0]];
  const capsule = (a, b, radius) => [2, ...scaled(a), ...scaled(b), radius * factor[0]];
  const buffers = shape.tables(14).map(bufferOf);
  const parts = [
    ...shape.structs(0, 4).map((n) => ball(n.slice(0, 3), n[3])),
    ...shape.structs(1, 10).map((n, i) => [1, ...scaled(n.slice(0, 3)), ...(axes[i] ? turnOfAxes(axes[i]) : n.slice(3, 7)), ...scaled(n.slice(7, 10))]),
    ...shape.structs(2, 7).map((n) => [2, ...ends(n)]), ...shape.structs(5, 7).map((n) => [3, ...ends(n)]), ...shape.structs(6, 7).map((n) => [4, ...ends(n)]),
    ...shape.structs(7, 15).map((n) => [5, ...scaled(n.slice(0, 3)), ...turnOfAxes(n.slice(3, 12)), ...scaled(n.slice(12, 15))]),
    ...shape.structs(9, 6).map((n) => [6, ...scaled(n)]),
    ...shape.tables(11).flatMap((cloud) => pointsOf(cloud).map((point) => ball(point, cloud.number(1)))),
    ...shape.tables(12).flatMap((way) => pointsOf(way).map((point, i, all) => capsule(all[Math.max(0, i - 1)], point, way.number(1))).slice(1)),
    ...buffers.flatMap(({ points, segments, radius }) => [...points.map((point) => ball(point, radius)), ...segments.map(([a, b]) => capsule(a, b, radius))]),
    ...shape.tables(17).flatMap((voxels) => voxelParts(voxels, scaled)),
  ];
  const heights = shape.table(10);
  const surfaces = [
    ...[shape.table(3)].filter(Boolean).map((mesh) => [pointsOf(mesh), cornersOf(mesh)]),
    ...shape.tables(8).map((hull) => [pointsOf(hull), convexHull(pointsOf(hull)).flat()]),  // its corners, if it has any, are not used
    ...(heights ? [gridOf(heights)] : []),
    ...buffers.map(({ vertices, corners }) => [vertices, corners]),
  ];
  return { parts, meshes: surfaces.filter(([, corners]) => corners.length > 0).map(([vertices, corners]) => surfaceOfMesh(vertices.map(scaled), Uint32Array.from(corners))) };
}

function pointsOf(table) {
  const { first, count } = table.list(0);
  return Array.from({ length: Math.floor(count / 3) }, (_, i) => table.doubles(first + 24 * i, 3));
}
function cornersOf(mesh) {
  const { first, count } = mesh.list(1);
  return Array.from({ length: count }, (_, i) => mesh.view.getUint32(first + 4 * i, true));
}

/// The vertices and corners of a height field.
function gridOf(field) {
  const columns = field.whole(0);
  const [dx, dy] = [field.number(1), field.number(2)];
  const { first, count } = field.list(3);
  const vertices = field.doubles(first, count).map((height, i) => [(i % columns) * dx, Math.floor(i / columns) * dy, height]);
  const corners = vertices.flatMap((_, i) => (i % columns === columns - 1 || i + columns >= count ? [] : [i, i + 1, i + columns + 1, i, i + columns + 1, i + columns]));
  return [vertices, corners];
}

function voxelParts(voxels, scaled) {
  const cell = voxels.number(0);
  const low = [1, 2, 3].map((member) => voxels.whole(member));
  const { first, count } = voxels.list(7);
  const boxes = [];
  voxelBoxes([4, 5, 6].map((member) => voxels.whole(member)), new Uint8Array(voxels.view.buffer, voxels.view.byteOffset + first, count), (at, cells) => {
    boxes.push([1, ...scaled(cells.map((size, axis) => (2 * (low[axis] + at[axis]) + size) * (cell / 2))), 1, 0, 0, 0, ...scaled(cells.map((size) => size * (cell / 2)))]);
  });
  return boxes;
}

/// A vertex buffer: {points, segments [[point, point]], radius, vertices, corners}.
function bufferOf(buffer) {
  const { view } = buffer;
  const [kind, isDouble] = [buffer.byte(0), buffer.byte(1)];
  const [stride, offset, indexBytes] = [buffer.whole(2), buffer.whole(3), buffer.whole(5)];
  const [bytes, indices] = [buffer.list(4), buffer.list(6)];
  const number = (at, axis) => (isDouble ? view.getFloat64(at + 8 * axis, true) : view.getFloat32(at + 4 * axis, true));
  const vertices = Array.from({ length: Math.ceil(bytes.count / stride) }, (_, i) => [0, 1, 2].map((axis) => number(bytes.first + i * stride + offset, axis)));
  const order = indexBytes ? Array.from({ length: indices.count / indexBytes }, (_, i) => (indexBytes === 2 ? view.getUint16(indices.first + 2 * i, true) : view.getUint32(indices.first + 4 * i, true))) : vertices.map((_, i) => i);
  const at = (i) => vertices[order[i]];
  const made = { points: [], segments: [], radius: buffer.number(7), vertices, corners: [] };
  if (kind === 0) made.points = order.map((_, i) => at(i));
  else if (kind === 1) made.segments = order.flatMap((_, i) => (i % 2 ? [[at(i - 1), at(i)]] : []));
  else if (kind === 2) made.segments = order.slice(1).map((_, i) => [at(i), at(i + 1)]);
  else if (kind === 3) made.corners = order;
  else if (kind === 4) made.corners = order.slice(2).flatMap((last, i) => [order[0], order[i + 1], last]);
  else made.corners = order.slice(2).flatMap((last, i) => stripTriangle(order[i], order[i + 1], last, i));
  return made;
}
/// Every other triangle of a strip is turned around; one with two equal corners only steers.
function stripTriangle(a, b, c, i) {
  if (a === b || b === c || c === a) return [];
  return i % 2 ? [b, a, c] : [a, b, c];
}

/// The rotation whose columns are given; they are orthonormal.
function turnOfAxes([a, b, c, d, e, f, g, h, i]) {
  const candidates = [[1 + a + e + i, f - h, g - c, b - d], [f - h, 1 + a - e - i, b + d, g + c], [g - c, b + d, 1 - a + e - i, f + h], [b - d, g + c, f + h, 1 - a - e + i]];
  const turn = candidates.reduce((best, one, k) => (one[k] > best.size ? { size: one[k], one } : best), { size: -Infinity }).one;
  const norm = Math.hypot(...turn);
  return turn.map((part) => part / norm);
}
