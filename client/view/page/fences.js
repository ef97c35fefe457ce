/// Fences and the bands of margins, as the server tells them: where they stand, and what is in them.
class Fences {
  constructor() {
    this.all = [];
    this.changes = 0;
  }

  set(fences) {
    this.all = fences.map((fence) => ({
      ...fence,
      isEntered: fence.inside.length + fence.in_doubt.length > 0,
      points: fence.lines.map((line) => Array.from({ length: line.length / 3 }, (_, i) => line.slice(3 * i, 3 * i + 3).map(Number))),
    }));
    ++this.changes;
  }

  /// Some of them move, or have changed since the last picture that was told.
  areElsewhere() {
    const isNew = this.shownChanges !== this.changes;
    this.shownChanges = this.changes;
    return isNew || this.all.some(({ to }) => to);
  }

  /// Calls draw(from, to, fence) for each piece of a line, in the world. A fence whose carrier is not there has no place.
  forEachPiece(world, draw) {
    for (const fence of this.all) {
      const carrier = fence.to ? world.byName.get(fence.to) : null;
      if (fence.to && (!carrier || carrier.isHidden)) continue;
      const place = carrier ? (point) => add(carrier.position, rotate(carrier.turn, point)) : (point) => point;
      for (const line of fence.points) {
        const points = line.map(place);
        for (let i = 0; i + 1 < points.length; ++i) draw(points[i], points[i + 1], fence);
      }
    }
  }

  bounds(fence, world) {
    const bounds = new Bounds();
    const carrier = fence.to ? world.byName.get(fence.to) : null;
    for (const line of fence.points) for (const point of line) bounds.extend(carrier ? add(carrier.position, rotate(carrier.turn, point)) : point);
    return bounds;
  }
}

const kMostFencesListed = 200;

/// The panel that lists them; what is entered comes first. A click brings one into the picture.
class FenceList {
  /// on: {frame(fence)}
  constructor(on) {
    this.on = on;
  }

  show(fences) {
    byId("panel-fences").hidden = fences.all.length === 0;
    if (this.shown === fences.changes) return;
    this.shown = fences.changes;
    const entered = fences.all.filter(({ isEntered }) => isEntered).length;
    setText(byId("fence-count"), `${countText(fences.all.length)}, ${countText(entered)} entered`);
    const order = [...fences.all].sort((a, b) => b.isEntered - a.isEntered).slice(0, kMostFencesListed);
    byId("fences").replaceChildren(...order.map((fence) => this.row(fence)));
  }

  /// Of a question for the nearest: how far from whom.
  nearness({ nearest_to, distance }) {
    const from = nearest_to ? nameElement(nearest_to) : "a point";
    return distance === undefined ? [" near ", from] : [distance === 0 ? " touches " : ` ${lengthText(distance)} from `, from];
  }

  row(fence) {
    const parts = [nameElement(fence.name)];
    if (fence.nearest_to !== undefined) parts.push(...this.nearness(fence));
    else if (fence.within !== undefined) parts.push(` ${lengthText(fence.within)} about `, nameElement(fence.to));
    else if (fence.to) parts.push(element("small", {}, " on ", nameElement(fence.to)));
    const who = [...fence.inside.map((name) => nameElement(name)), ...fence.in_doubt.map((name) => element("span", {}, "perhaps ", nameElement(name)))];
    return element("li", { class: fence.isEntered ? "entered" : "" },
      element("button", { type: "button", class: "link", onclick: () => this.on.frame(fence) }, ...parts),
      element("span", { class: "who" }, ...who.flatMap((one, i) => (i ? [", ", one] : [one]))));
  }
}
