/// The object in whose frame a standing question's lines are; "": they are in the world.
const carrierOf = ({ form, to, about }) => ({ region: to, bands: about })[form] ?? "";

/// Standing questions: regions, bands about objects, and lines to the nearest; their places, and the objects that they
/// hold.
class Standing {
  constructor() {
    this.all = [];
    this.changes = 0;
  }

  set(rows) {
    this.all = rows.map((row) => ({
      ...row,
      carrier: carrierOf(row),
      isHeld: row.holds.length > 0,
      points: (row.lines ?? []).map((line) => Array.from({ length: line.length / 3 }, (_, i) => line.slice(3 * i, 3 * i + 3).map(Number))),
    }));
    ++this.changes;
  }

  /// Some of them move, or have changed since the last picture.
  areElsewhere() {
    const isNew = this.shownChanges !== this.changes;
    this.shownChanges = this.changes;
    return isNew || this.all.some(({ carrier }) => carrier);
  }

  /// Calls draw(from, to, row) for each piece of a line, in the world. Lines whose carrier does not exist have no
  /// place.
  forEachPiece(world, draw) {
    for (const row of this.all) {
      const carrier = row.carrier ? world.byName.get(row.carrier) : null;
      if (row.carrier && (!carrier || carrier.isHidden)) continue;
      const place = carrier ? (point) => add(carrier.position, rotate(carrier.turn, point)) : (point) => point;
      for (const line of row.points) {
        const points = line.map(place);
        for (let i = 0; i + 1 < points.length; ++i) draw(points[i], points[i + 1], row);
      }
    }
  }

  bounds(row, world) {
    const bounds = new Bounds();
    const carrier = row.carrier ? world.byName.get(row.carrier) : null;
    for (const line of row.points) for (const point of line) bounds.extend(carrier ? add(carrier.position, rotate(carrier.turn, point)) : point);
    return bounds;
  }
}

const kMostStandingListed = 200;

/// The panel that lists them; those that hold an object come first. A click brings one into the picture.
class StandingList {
  /// on: {frame(row)}
  constructor(on) {
    this.on = on;
  }

  show(standing) {
    byId("panel-standing").hidden = standing.all.length === 0;
    if (this.shown === standing.changes) return;
    this.shown = standing.changes;
    const held = standing.all.filter(({ isHeld }) => isHeld).length;
    setText(byId("standing-count"), `${countText(standing.all.length)}, ${countText(held)} entered`);
    const order = [...standing.all].sort((a, b) => b.isHeld - a.isHeld).slice(0, kMostStandingListed);
    byId("standing").replaceChildren(...order.map((row) => this.row(row)));
  }

  /// The text after the name: the carrier of a region, the band and its object, or the distance of the nearest.
  place({ form, to, about, band, distance }) {
    if (form === "region") return to ? [element("small", {}, " on ", nameElement(to))] : [];
    if (form === "bands") return [` ${lengthText(band)} about `, nameElement(about)];
    const from = to ? nameElement(to) : "a point";
    return distance === undefined ? [" near ", from] : [distance === 0 ? " touches " : ` ${lengthText(distance)} from `, from];
  }

  row(row) {
    const held = row.holds.map(({ object, in_doubt }) => (in_doubt ? element("span", {}, "perhaps ", nameElement(object)) : nameElement(object)));
    return element("li", { class: row.isHeld ? "entered" : "" },
      element("button", { type: "button", class: "link", onclick: () => this.on.frame(row) }, nameElement(row.name), ...this.place(row)),
      element("span", { class: "held" }, ...held.flatMap((one, i) => (i ? [", ", one] : [one]))));
  }
}
