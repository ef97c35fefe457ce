/// Pairs that touch or have touched, newest last.
class Contacts {
  constructor() {
    this.pairs = new Map();
    this.changes = 0;
  }
  key({ a, b }) { return `${a}\n${b}`; }

  copy() {
    const same = new Contacts();
    for (const [key, pair] of this.pairs) same.pairs.set(key, { ...pair, flashed: -Infinity });
    return same;
  }

  /// All open contacts.
  set(contacts) {
    for (const pair of this.pairs.values()) pair.holds = false;
    for (const contact of contacts) this.hear(contact, -Infinity);
  }
  hear(event, now) {
    ++this.changes;
    const key = this.key(event);
    const known = this.pairs.get(key) || { a: event.a, b: event.b, times: 0, flashed: -Infinity };
    this.pairs.delete(key);
    this.pairs.set(key, known);
    known.a_slot = event.a_slot;
    known.b_slot = event.b_slot;
    known.holds = event.what !== "ended";
    known.doubt = event.doubt;
    known.contained = event.contained;
    if (event.point) Object.assign(known, { point: event.point, normal: event.normal, depth: event.depth, error: event.error });
    if (event.what === "began") {
      known.flashed = now;
      ++known.times;
    }
    if (this.pairs.size > 2000) this.forget();
  }
  forget() {
    for (const [key, pair] of this.pairs) {
      if (this.pairs.size <= 1500) return;
      if (!pair.holds) this.pairs.delete(key);
    }
  }
  newest() { return [...this.pairs.values()].reverse(); }
  of(name) { return this.newest().filter(({ a, b, holds }) => holds && (a === name || b === name)); }
}

const kFlash_ms = 900;
const kRay_ms = 5000;
const kMarkFloats = 10;
const kMostMarks = 12000;
const kClusterPixels = 18;

/// Contacts, rays and clearances as marks over the picture: lines, rings and dots, and their texts.
class Marks {
  constructor() {
    this.data = new Float32Array(kMostMarks * kMarkFloats);
    this.count = 0;
    this.texts = [];  // {point, text}, for the overlay
    this.rays = [];
    this.line = null;     // {from, to, text}: the clearance of the object under the pointer
    this.nearest = null;  // the same, of the object nearest to the chosen one
    this.asked = null;    // {pieces, texts} of the newest answer (tools.js)
    this.preview = [];    // pieces of a question that is being drawn
    this.others = [];     // {pieces, at}: other clients' questions (others.js)
    this.isCalm = matchMedia("(prefers-reduced-motion: reduce)");
  }

  put(from, to, width, kind, strength, accent) {
    if (this.count >= kMostMarks) return;
    const at = kMarkFloats * this.count++;
    for (let axis = 0; axis < 3; ++axis) {
      this.data[at + axis] = from[axis] - this.anchor[axis];
      this.data[at + 3 + axis] = to[axis] - this.anchor[axis];
    }
    this.data[at + 6] = width;
    this.data[at + 7] = kind;
    this.data[at + 8] = strength;
    this.data[at + 9] = accent;
  }

  /// Places everything for a picture; returns whether some of it is animated. size: the picture's, in pixels of the
  /// screen.
  place(contacts, standing, world, camera, [width, height], isShown, now) {
    this.count = 0;
    this.texts = [];
    this.anchor = world.anchor;
    this.placeStanding(standing, world);
    const clusters = new Map();
    this.places = [];
    let isFlashing = false;
    for (const pair of contacts.pairs.values()) {
      const age = (now - pair.flashed) / kFlash_ms;
      const flash = age >= 0 && age < 1 ? 1 - age : 0;
      if ((!pair.holds && flash === 0) || !pair.point || !pair.point.every(Number.isFinite) || !isShown(pair)) continue;
      const seen = camera.project(pair.point);
      if (!seen || Math.abs(seen[0]) > 1.1 || Math.abs(seen[1]) > 1.1) continue;
      isFlashing = isFlashing || flash > 0;
      this.places.push(seen);
      const key = `${Math.floor((seen[0] * width) / 2 / kClusterPixels)} ${Math.floor((seen[1] * height) / 2 / kClusterPixels)}`;
      if (!clusters.has(key)) clusters.set(key, []);
      clusters.get(key).push({ pair, flash, meter: height / (2 * camera.halfHeight * seen[2]) });
    }
    for (const cluster of clusters.values()) this.putCluster(cluster);
    this.placeRays(camera, now);
    this.placeOthers(now);
    for (const clearance of [this.line, this.nearest]) if (clearance) this.placeClearance(clearance);
    for (const piece of [...this.preview, ...(this.asked?.pieces || [])]) this.put(...piece);
    if (this.asked) this.texts.push(...this.asked.texts);
    return isFlashing || this.rays.length > 0 || this.others.length > 0;
  }

  placeClearance({ from, to, text }) {
    this.put(from, to, 1.5, 0, 1, 1);
    for (const end of [from, to]) this.put(end, end, 5, 2, 1, 1);
    this.texts.push({ point: scale(add(from, to), 0.5), text });
  }

  /// A region of the picture (world.js) grown so that it holds all marks; null if they may be anywhere.
  region(region, camera, width, height) {
    if (!region || this.rays.length > 0 || this.others.length > 0 || this.line || this.nearest || this.asked || this.preview.length > 0 || this.areStandingElsewhere) return null;
    const reach_px = 30;
    for (const [x, y] of this.places) extendRegion(region, (x + 1) / 2, (y + 1) / 2, reach_px / width, reach_px / height);
    return region;
  }

  /// Contacts that are too close to be distinguished: one mark with the number of open ones. Ended ones only flash.
  putCluster(cluster) {
    const flash = Math.max(...cluster.map((one) => one.flash));
    const held = cluster.filter(({ pair }) => pair.holds);
    if (held.length <= 1) return this.putContact(held[0] ?? cluster[0], flash);
    const points = held.map(({ pair }) => pair.point);
    const middle = scale(points.reduce(add), 1 / points.length);
    this.put(middle, middle, 7 + Math.min(5, Math.log2(held.length)), 2, 0.9, 1);
    if (flash > 0) this.put(middle, middle, 16, 1, flash, 1);
    this.texts.push({ point: middle, text: String(held.length), beside: true });
  }

  /// A dot, no larger than an object of 10 cm would be but never too small to see; near by, normal and depth to scale.
  putContact({ pair: { point, normal, depth, holds }, meter }, flash) {
    const dot_px = Math.max(3, Math.min(6, 0.1 * meter));
    this.put(point, point, dot_px, 2, holds ? 1 : flash, 1);
    if (flash > 0) this.put(point, point, this.isCalm.matches ? 14 : 8 + 14 * (1 - flash), 1, flash, 1);
    if (!normal) return;
    const normal_m = Math.min(0.25, 16 / meter);
    if (normal_m * meter > 5) this.put(point, add(point, scale(normal, normal_m)), 1, 0, 0.9, 1);
    const depth_px = Number(depth) * meter;
    if (depth_px > 4 && Number.isFinite(depth_px)) this.put(subtract(point, scale(normal, depth / 2)), add(point, scale(normal, depth / 2)), 3, 0, 0.8, 0);
  }

  /// A question that holds an object is lit.
  placeStanding(standing, world) {
    this.areStandingElsewhere = standing.areElsewhere();
    standing.forEachPiece(world, (from, to, { isHeld, form }) => {
      if (isHeld) this.put(from, to, 2, 0, 1, 1);
      else this.put(from, to, 1.2, 0, form === "bands" ? 0.3 : 0.6, 0);
    });
  }

  placeOthers(now) {
    this.others = this.others.filter(({ at }) => now - at < kOtherShown_ms);
    for (const { pieces, at } of this.others) {
      const left = 1 - (now - at) / kOtherShown_ms;
      for (const [from, to, width, kind, strength, accent] of pieces) this.put(from, to, width, kind, 0.5 * left * strength, accent);
    }
  }

  placeRays(camera, now) {
    this.rays = this.rays.filter(({ at }) => now - at < kRay_ms);
    const size = camera.distance * camera.halfHeight;
    for (const { from, to, at, met, normal } of this.rays) {
      const left = 1 - (now - at) / kRay_ms;
      this.put(from, to, 1.5, 0, left, met ? 1 : 0.3);
      if (!met) continue;
      this.put(to, to, 6, 2, left, 1);
      this.put(to, add(to, scale(normal, size * 0.08)), 1.5, 0, left, 0);
    }
  }
}
