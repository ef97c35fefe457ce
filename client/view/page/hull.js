/// The convex hull of points, as triangles of their numbers that look outward; [] where they lie in one plane. What is nearer to
/// it than roundings counts as inside: it is for drawing, the server's is exact.
///
/// source  de Berg, Cheong, van Kreveld, Overmars, "Computational Geometry", 3rd ed., 11.2, without its conflict lists
function convexHull(points) {
  const most = 4096;  // as a server takes; time grows with the square
  if (points.length > most) throw new Error("a hull of too many points");
  const first = firstTetrahedron(points);
  if (!first) return [];
  const [a, b, c, d] = first.corners;
  const faceOf = (i, j, k) => {
    const normal = normalized(cross(subtract(points[j], points[i]), subtract(points[k], points[i])));
    return { corners: [i, j, k], normal, offset: dot(normal, points[i]) };
  };
  let faces = [[a, b, c], [a, c, d], [a, d, b], [b, d, c]].map((corners) => faceOf(...corners));
  points.forEach((point, number) => {
    const isSeen = ({ normal, offset }) => dot(normal, point) - offset > first.slack;
    const seen = faces.filter(isSeen);
    if (seen.length === 0) return;
    // The border of what is seen from the point: edges that only one of these faces has.
    const edges = new Set(seen.flatMap(({ corners: [i, j, k] }) => [`${i} ${j}`, `${j} ${k}`, `${k} ${i}`]));
    const border = [...edges].map((edge) => edge.split(" ").map(Number)).filter(([i, j]) => !edges.has(`${j} ${i}`));
    faces = faces.filter((face) => !isSeen(face));
    for (const [i, j] of border) faces.push(faceOf(i, j, number));
  });
  return faces.map(({ corners }) => corners);
}

/// Four points far from each other, the fourth behind the triangle of the others, and how far off roundings may be.
function firstTetrahedron(points) {
  const farthest = (away) => points.reduce((best, point, i) => (away(point) > best.away ? { away: away(point), i } : best), { away: -1, i: 0 });
  const a = 0;
  const to = (i, j) => subtract(points[j], points[i]);
  const b = farthest((point) => length(subtract(point, points[a])));
  const slack = 1e-10 * (b.away + length(points[a]));
  if (!(b.away > slack)) return null;
  const along = normalized(to(a, b.i));
  const c = farthest((point) => length(cross(along, subtract(point, points[a]))));
  if (!(c.away > slack)) return null;
  const normal = normalized(cross(along, to(a, c.i)));
  const d = farthest((point) => Math.abs(dot(normal, subtract(point, points[a]))));
  if (!(d.away > slack)) return null;
  const isBehind = dot(normal, to(a, d.i)) < 0;
  return { corners: isBehind ? [a, b.i, c.i, d.i] : [a, c.i, b.i, d.i], slack };
}
