// The questions asked by a click or a drag in the picture. A ray needs only a direction; the others need places in the
// world.
const kTools = ["ray", "sphere", "box", "near", "sweep", "pair"];
const kToolHints = {
  ray: "asks a ray", sphere: "or drag asks what touches a ball", box: "or drag asks what touches a box", near: "asks what is nearest", sweep: "twice or drag sweeps a ball", pair: "on two things compares them",
};
const kNearestAsked = 3;

/// Turns clicks and drags into questions, and shows their shapes while they are drawn.
class Tools {
  /// on: {ask(question), ray(x, y), pick(x, y) (as Renderer.pick), choose(slot), chosen(), name(slot), drawn()};
  /// x and y from -1 to 1, y up
  constructor(world, camera, marks, on) {
    this.world = world;
    this.camera = camera;
    this.marks = marks;
    this.on = on;
    this.kind = "ray";
    this.start = null;    // of a drag: {point, normal}
    this.waiting = null;  // of a sweep: where it begins, until its end is clicked
    byId("tool").addEventListener("change", () => this.take(byId("tool").value));
    this.take(remembered.get("tool", "ray"));
  }

  take(kind) {
    this.kind = kTools.includes(kind) ? kind : "ray";
    byId("tool").value = this.kind;
    byId("tool-size").hidden = !["sphere", "box", "sweep"].includes(this.kind);
    byId("tool-size").title = this.kind === "box" ? "Its edges, in metres" : "Its radius, in metres";
    for (const hint of document.querySelectorAll(".asks")) hint.textContent = `${hint.classList.contains("touch") ? "tap" : "click"} ${kToolHints[this.kind]}`;
    remembered.set("tool", this.kind);
    this.cancel();
  }
  cancel() {
    this.start = this.waiting = null;
    this.preview([]);
  }
  drags() { return ["sphere", "box", "sweep"].includes(this.kind); }

  size() {
    const given = Number(byId("tool-size").value);
    return Number.isFinite(given) && given > 0 ? given : 0.5;
  }

  // ---- places

  /// As many digits as the picture shows, so that a command can be typed again.
  rounded(point) {
    const digits = Math.min(9, Math.max(0, 5 - Math.floor(Math.log10(this.camera.distance))));
    return point.map((part) => Number(part.toFixed(digits)) + 0);
  }

  /// The visible point, or the ground behind it, or a place at the camera's target distance: {point, normal, slot}.
  placeAt(x, y) {
    const eye = this.camera.eye();
    const seen = this.on.pick(x, y);
    if (seen) {
      const direction = this.camera.direction(...seen.middle.map((part) => 2 * part - 1));
      return { point: add(eye, scale(normalized(direction), seen.range)), normal: seen.normal, slot: seen.slot };
    }
    const direction = this.camera.direction(x, y);
    const axis = this.upAxis();
    const up = [0, 0, 0];
    up[axis] = 1;
    const ground = this.world.bounds.isEmpty() ? 0 : this.world.bounds.low[axis];
    const along = (ground - eye[axis]) / direction[axis];
    const isNear = along > 0 && along < 4 * this.camera.distance;
    return { point: add(eye, scale(direction, isNear ? along : this.camera.distance)), normal: up, slot: null };
  }
  upAxis() { return this.camera.yIsUp ? 1 : 2; }

  /// The target of a drag from a point: along the ground, or across a view in which the ground is nearly edge-on.
  placeInPlane(x, y, point, isFacing) {
    const { back } = this.camera.axes();
    const up = [0, 0, 0];
    up[this.upAxis()] = 1;
    const isFlat = Math.abs(dot(back, up)) < 0.2;
    const normal = isFacing || isFlat ? back : up;
    const eye = this.camera.eye();
    const direction = this.camera.direction(x, y);
    const along = dot(subtract(point, eye), normal) / dot(direction, normal);
    return along > 0 ? add(eye, scale(direction, along)) : null;
  }

  // ---- clicks and drags

  click(x, y) {
    if (this.kind === "ray") return this.on.ray(x, y);
    const place = this.placeAt(x, y);
    if (this.kind === "near") return this.on.ask({ ask: "near", point: this.rounded(place.point), count: kNearestAsked });
    if (this.kind === "pair") return this.askPair(place.slot);
    if (this.kind === "sphere") return this.on.ask({ ask: "sphere", center: this.rounded(place.point), radius: this.size() });
    if (this.kind === "box") return this.on.ask({ ask: "box", center: this.rounded(place.point), half: [0, 0, 0].map(() => this.size() / 2) });
    if (!this.waiting) {
      this.waiting = this.rounded(this.besides(place));
      return this.preview(ballPieces(this.waiting, this.size()));
    }
    const to = this.placeInPlane(x, y, this.waiting, false);
    const from = this.waiting;
    this.cancel();
    if (to) this.askSweep(from, to);
  }

  /// A ball that lies there without touching.
  besides({ point, normal }) { return add(point, scale(normal, 1.02 * this.size())); }

  /// The first click chooses, the second one asks.
  askPair(slot) {
    if (slot === null) return;
    const chosen = this.on.chosen();
    if (chosen && chosen.slot !== slot) this.on.ask({ ask: "pair", a: chosen.name, b: this.on.name(slot) });
    else this.on.choose(slot);
  }
  askSweep(from, to) { this.on.ask({ ask: "sweep", radius: this.size(), from, to: this.rounded(to) }); }

  /// Returns whether the drag belongs to the tool; else it turns the camera.
  beginDrag(x, y) {
    if (!this.drags()) return false;
    const place = this.placeAt(x, y);
    this.start = this.rounded(this.kind === "sweep" ? this.besides(place) : place.point);
    return true;
  }
  drag(x, y) {
    const question = this.start && this.dragged(x, y);
    if (question) this.preview(questionPieces(question));
  }
  endDrag(x, y) {
    const question = this.start && this.dragged(x, y);
    this.cancel();
    if (question) this.on.ask(question);
  }

  dragged(x, y) {
    const from = this.start;
    const to = this.placeInPlane(x, y, from, this.kind === "sphere");
    if (!to) return null;
    if (this.kind === "sphere") return { ask: "sphere", center: from, radius: this.rounded([length(subtract(to, from))])[0] };
    if (this.kind === "sweep") return { ask: "sweep", radius: this.size(), from, to: this.rounded(to) };
    const half = this.rounded(subtract(to, from).map(Math.abs));
    const axis = this.upAxis();
    half[axis] = Math.max(half[axis], this.size() / 2);
    return { ask: "box", center: from, half };
  }

  preview(pieces) {
    this.marks.preview = pieces;
    this.on.drawn();
  }
}

// ---- the shapes of questions, as lines for Marks: [from, to, width, kind, strength, accent]

const line = (from, to, width = 1.2, accent = 1) => [from, to, width, 0, 0.9, accent];
const dotAt = (point, size = 6, accent = 1) => [point, point, size, 2, 1, accent];

/// Three circles about a point.
function ballPieces(center, radius, sides = 40) {
  return [[0, 1], [0, 2], [1, 2]].flatMap(([u, v]) => {
    const at = (i) => {
      const point = [...center];
      point[u] += radius * Math.cos((2 * Math.PI * i) / sides);
      point[v] += radius * Math.sin((2 * Math.PI * i) / sides);
      return point;
    };
    return Array.from({ length: sides }, (_, i) => line(at(i), at(i + 1)));
  });
}

function boxPieces(center, half, turn = [1, 0, 0, 0]) {
  const corner = (bits) => add(center, rotate(turn, half.map((part, axis) => (bits & (1 << axis) ? part : -part))));
  return [0, 1, 2].flatMap((axis) => [0, 1, 2, 3, 4, 5, 6, 7].filter((bits) => !(bits & (1 << axis))).map((bits) => line(corner(bits), corner(bits | (1 << axis)))));
}

function questionPieces(question) {
  if (question.ask === "sphere") return ballPieces(question.center, question.radius);
  if (question.ask === "box") return boxPieces(question.center, question.half);
  if (question.ask === "near") return [dotAt(question.point, 8)];
  if (question.ask === "sweep") return [...ballPieces(question.from, question.radius), line(question.from, question.to, 2), ...ballPieces(question.to, question.radius).map((piece) => [...piece.slice(0, 4), 0.4, 0])];
  return [];
}

/// The answer's additions to its question's shape: {pieces, texts [{point, text}]}.
function answerPieces(question, answer) {
  const pieces = questionPieces(question);
  const texts = [];
  for (const { point, normal, distance, time_low } of answer.hits || []) {
    if (!point.every(Number.isFinite)) continue;
    pieces.push(dotAt(point));
    if (question.ask === "near") {
      pieces.push(line(question.point, point));
      texts.push({ point: scale(add(question.point, point), 0.5), text: lengthText(Number(distance)) });
    } else if (question.ask === "sweep") {
      const way = subtract(question.to, question.from);
      pieces.push(...ballPieces(add(question.from, scale(way, time_low)), question.radius), line(point, add(point, scale(normal, question.radius)), 1.5, 0));
    }
  }
  if (question.ask === "pair" && answer.on_a && answer.on_b) {
    pieces.push(line(answer.on_a, answer.on_b, 1.5), dotAt(answer.on_a, 5), dotAt(answer.on_b, 5));
    texts.push({ point: scale(add(answer.on_a, answer.on_b), 0.5), text: lengthText(answer.distance) });
  } else if (question.ask === "pair" && answer.point) pieces.push(dotAt(answer.point));
  return { pieces, texts };
}
