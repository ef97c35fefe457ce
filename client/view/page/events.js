const kMostEventsShown = 60;

/// The newest events, the depth first, since it matters most. A click goes to an event's instant.
class EventList {
  /// on: {goTo(t, event)}
  constructor(on) {
    this.on = on;
    this.list = byId("events");
    // While the pointer rests on the list it does not change, so that an event can be clicked.
    this.list.addEventListener("pointerenter", (event) => { this.isHeld = event.pointerType === "mouse"; });
    this.list.addEventListener("pointerleave", () => { this.isHeld = false; });
    for (const filter of ["event-name", "event-kind"]) byId(filter).addEventListener("input", () => { this.isHeld = false; this.shown = null; });
  }

  show(timeline) {
    if (this.isHeld) return;
    const wanted = byId("event-name").value.trim();
    const kind = byId("event-kind").value;
    const isFiltered = wanted || kind;
    const mostSearched = 5000;
    const expression = wanted ? globExpression(wanted) : null;
    const events = timeline.eventsShown(isFiltered ? mostSearched : kMostEventsShown)
      .filter(({ event }) => (!kind || event.what === kind) && (!expression || expression.test(event.a) || expression.test(event.b)))
      .slice(0, kMostEventsShown);
    const shown = `${events.length} ${events[0]?.event.sequence} ${wanted} ${kind}`;
    if (shown === this.shown) return;
    this.shown = shown;
    byId("no-events").hidden = events.length > 0;
    keepNewest(this.list, events.map(({ t, event }) => [`${event.sequence} ${t}`, () => this.row(t, event)]));
  }

  row(t, event) {
    const ends = event.what === "ended";
    const depth = ends ? "" : event.what === "contained" ? "inside" : event.what === "emerged" ? "emerged" : depthText(event);
    const why = ends ? (event.why === "separated" ? "apart" : event.why.replaceAll("_", " ")) : "";
    return element("li", { class: event.what }, element("button", { type: "button", onclick: () => this.on.goTo(t, event) },
      element("span", { class: "depth" }, depth || why),
      element("span", { class: "pair" }, shortNameElement(event.a), " × ", shortNameElement(event.b)),
      element("time", {}, clockText(event.time))));
  }
}

/// Like keepChildren, for a list whose new items come first: those before the first known one are put before it.
function keepNewest(list, items) {
  const first = list.firstElementChild;
  const known = first ? items.findIndex(([key]) => key === first.key) : -1;
  for (const [key, make] of known > 0 ? items.slice(0, known) : []) {
    const made = make();
    made.key = key;
    list.insertBefore(made, first);
  }
  keepChildren(list, items);
}
