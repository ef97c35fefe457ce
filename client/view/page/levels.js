// Decides which of two coinciding faces is visible: an object of a higher level is drawn farther along the same rays
// (farther_of in the shaders), so the choice does not depend on the rounding of a pixel.
const kMostLevels = 15;

/// Levels of static objects, by slot: where faces of two may coincide, the larger one has the higher level.
function levels(objects) {
  const still = objects.filter(({ moving, own, parts }) => !moving && (!own.isEmpty() || parts.length > 0))
    .map((object) => ({ object, bounds: placedBounds(object), size: object.own.isEmpty() ? Infinity : object.own.radius(), level: 0 }))
    .sort((a, b) => a.size - b.size);
  const mostCompared = 1500;
  const most = Math.max(0, still.length - mostCompared);  // of the smallest: their artefacts are invisible
  for (let i = most; i < still.length; ++i) {
    const one = still[i];
    for (let j = most; j < i; ++j) if (still[j].level >= one.level && mayCoincide(one.bounds, still[j].bounds)) one.level = Math.min(kMostLevels, still[j].level + 1);
  }
  const deepest = still.reduce((level, one) => Math.max(level, one.level), 0);
  const levelOf = new Map(still.map(({ object, level, size }) => [object.slot, size === Infinity ? Math.min(kMostLevels, deepest + 1) : level]));
  return roundLevels(still.flatMap(({ object }) => roundSurfaces(object)), levelOf);
}

/// Whether two boxes meet, and have a side in the same plane that faces the same way.
function mayCoincide(a, b) {
  const near = (x, y) => Math.abs(x - y) <= 1e-4;
  return [0, 1, 2].every((axis) => a.low[axis] <= b.high[axis] + 1e-4 && b.low[axis] <= a.high[axis] + 1e-4) &&
    [0, 1, 2].some((axis) => near(a.low[axis], b.low[axis]) || near(a.high[axis], b.high[axis]));
}

/// Levels by slot, different for any two objects whose round surfaces coincide: capsules that share a ball, cylinders
/// one behind the other. fixed: surfaces of other objects, which keep their levels of levelOf.
function roundLevels(surfaces, levelOf, fixed = []) {
  const found = new Map(levelOf);
  const keys = new Set(surfaces.map(({ key }) => key));
  const neighbours = coincidences([...surfaces, ...fixed.filter(({ key }) => keys.has(key))]);
  for (const slot of new Set(surfaces.map((surface) => surface.slot))) {
    if (!neighbours.has(slot)) continue;
    const taken = new Set([...neighbours.get(slot)].map((other) => found.get(other)));
    const first = levelOf.get(slot) ?? 0;
    const isFree = (level) => !taken.has(level % (kMostLevels + 1));
    let level = first;
    while (level <= first + kMostLevels && !isFree(level)) ++level;
    found.set(slot, level % (kMostLevels + 1));
  }
  return found;
}

/// The balls and tubes of an object in the world: {slot, key, center, axis, half (along the axis), slack, low, high
/// (along x)}. Only those of one key can coincide.
function roundSurfaces(object) {
  return object.parts.filter(([kind]) => kind !== 1 && kind !== kHalfSpace).flatMap((part) => {
    const { kind, position, turn, half } = solidOf(part, object);
    const center = add(object.position, rotate(object.turn, position));
    const axis = rotate(object.turn, rotate(turn, [0, 0, 1]));
    const radius = half[0];
    const slack = 1e-3 * radius;
    const surface = (what, middle, along) => {
      const reach = Math.abs(axis[0]) * along + slack;
      return { slot: object.slot, key: `${what} ${radius.toPrecision(4)}`, center: middle, axis, half: along, slack, low: middle[0] - reach, high: middle[0] + reach };
    };
    if (kind === 0) return [surface("ball", center, 0)];
    if (kind > 3) return [surface(`${kind} ${half.map((one) => one.toPrecision(4))}`, center, 0)];
    const along = kind === 2 ? half[2] - radius : half[2];
    const ends = kind === 2 ? [-along, along].map((at) => surface("ball", add(center, scale(axis, at)), 0)) : [];
    return [surface("tube", center, along), ...ends];
  });
}

/// By slot, the slots of other objects with a coinciding surface.
function coincidences(surfaces) {
  const found = new Map();
  const note = (a, b) => {
    if (!found.has(a)) found.set(a, new Set());
    found.get(a).add(b);
  };
  surfaces.sort((a, b) => a.low - b.low);
  let left = 200000;  // comparisons, since a picture must not wait
  const open = new Map();  // by key, those that reach the beginning of this one
  for (const one of surfaces) {
    const near = (open.get(one.key) ?? []).filter(({ high }) => high >= one.low);
    open.set(one.key, near);
    left -= near.length;
    if (left < 0) return found;
    for (const other of near) {
      if (other.slot === one.slot || !doCoincide(one, other)) continue;
      note(one.slot, other.slot);
      note(other.slot, one.slot);
    }
    near.push(one);
  }
  return found;
}

/// Whether balls have the same centre, or tubes lie on one line and meet.
function doCoincide(a, b) {
  const away = subtract(b.center, a.center);
  const along = dot(away, a.axis);
  const slack = Math.max(a.slack, b.slack);
  if (a.half === 0 && b.half === 0) return length(away) <= slack;
  return length(cross(a.axis, b.axis)) <= 1e-3 && length(subtract(away, scale(a.axis, along))) <= slack && Math.abs(along) <= a.half + b.half + slack;
}
