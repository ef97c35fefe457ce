const kAskEvery_ms = 500;
const kNearestEvery_ms = 100;  // at most this often, and rarely enough that the server works on it a fifth of the time

/// The panel about the chosen object: its details from the server, and its actions.
class Selected {
  /// on: {ask(question) -> id or null, choose(slot), frame(object), follow(slot), isolate(slot), hide(object),
  /// nearest({from, to, text} or null)}
  constructor(world, on) {
    this.world = world;
    this.on = on;
    this.slot = null;
    this.details = null;
    byId("follow").addEventListener("click", () => on.follow(this.slot));
    byId("isolate").addEventListener("click", () => on.isolate(this.slot));
    byId("frame").addEventListener("click", () => on.frame(this.object()));
    byId("hide").addEventListener("click", () => on.hide(this.object()));
    byId("deselect").addEventListener("click", () => on.choose(null));
  }

  object() { return this.world.objects.get(this.slot); }

  choose(slot) {
    this.slot = slot;
    this.details = null;
    this.trail = this.speed = null;
    this.askedAt = this.nearestDue = -Infinity;
    this.forgetNearest();
    this.show();
  }

  /// Repeats the questions about changing details, twice a second; while the page shows the past it shows its own
  /// memory.
  tick(now, isLive) {
    const object = this.object();
    if (!object) return;
    if (isLive && now - this.askedAt > kAskEvery_ms) {
      this.askedAt = now;
      this.asked = this.on.ask({ ask: "object", name: object.name });
    }
    if (!isLive) this.details = null;
    this.measureSpeed(object);
    this.show();
  }
  hear(answer) {
    if (answer.name === this.object()?.name) this.details = answer;
  }

  // ---- what is nearest

  /// Asks again after a pause that depends on the last answer's time; called for each picture.
  tickNearest(now, isLive) {
    const object = this.object();
    if (!object || !isLive) return this.forgetNearest();
    if (now < this.nearestDue) return;
    const patience_ms = 2000;  // an answer that has not arrived by then is lost
    this.nearestDue = now + patience_ms;
    this.nearestAskedAt = now;
    this.on.ask({ ask: "nearest", name: object.name });
  }
  hearNearest(answer) {
    if (answer.name !== this.object()?.name) return;
    const now = performance.now();
    this.nearestDue = now + Math.max(kNearestEvery_ms, 4 * (now - this.nearestAskedAt));
    this.nearest = answer;
    const isApart = answer.clearance > 0 && [...answer.on_a, ...answer.on_b].every(Number.isFinite);
    this.on.nearest(isApart ? { from: answer.on_a, to: answer.on_b, text: lengthText(answer.clearance) } : null);
  }
  forgetNearest() {
    if (this.nearest) this.on.nearest(null);
    this.nearest = null;
  }
  nearestRows() {
    const { nearest } = this;
    if (!nearest) return [];
    const late = nearest.late ? ", but there was no time to look at all" : "";
    if (!nearest.other) return [["nearest", nearest.late ? "not found in time" : "nothing else is there"]];
    const gap = nearest.answer === "undecided" && !nearest.late ? "undecided" : nearest.clearance > 0 ? `${lengthText(nearest.clearance)} (${boundText(nearest.error)})${late}` : nearest.clearance < 0 ? `${lengthText(-nearest.clearance)} deep${late}` : "touching";
    return [["nearest", element("button", { type: "button", class: "link", onclick: () => this.on.choose(this.world.byName.get(nearest.other)?.slot ?? null) }, shortNameElement(nearest.other))], ["clearance", gap]];
  }

  /// Speed from the poses of the last quarter of a second or so.
  measureSpeed(object) {
    const here = { time: this.world.worldTime, position: [...object.position] };
    const trail = (this.trail || []).filter(({ time }) => time <= here.time && here.time - time < 0.5);
    if (!trail.length || here.time > trail.at(-1).time) trail.push(here);
    this.trail = trail;
    const passed = here.time - trail[0].time;
    this.speed = passed > 0.05 ? length(subtract(here.position, trail[0].position)) / passed : null;
  }

  show() {
    const object = this.object();
    byId("panel-selected").hidden = !object;
    document.body.classList.toggle("has-selected", Boolean(object));
    if (!object) return;
    const name = byId("selected-name");
    if (name.textContent !== object.name) name.replaceChildren(nameElement(object.name));
    const known = this.details || {};
    const rows = [["kind", [known.kind, object.moving ? "moves" : "does not move", known.solid ? "solid" : ""].filter(Boolean).join(", ")]];
    if (object.scene) rows.push(["scene", nameElement(object.scene)]);
    if (object.publisher || known.publisher) rows.push(["moved by", nameElement(known.publisher || object.publisher)]);
    if (!object.isThere) rows.push(["position", `${pointText(object.position)} m`], ["turn (w x y z)", object.turn.map((part) => roundedText(part, 4)).join(" ")]);
    if (object.moving && Number.isFinite(this.speed)) rows.push(["speed", `${lengthText(Number(this.speed.toFixed(4)))}/s`]);
    if (known.age !== undefined) rows.push(["age", durationText(known.age), object.moving && known.age > 2]);
    if (known.bounds?.flat().every(Number.isFinite)) rows.push(["size", `${subtract(known.bounds[1], known.bounds[0]).map((part) => roundedText(part, 3)).join(" × ")} m`]);
    if (known.triangles) rows.push(["triangles", countText(known.triangles)]);
    rows.push(["layers, mask", `${object.layers.toString(2)}, ${object.mask === 0xffffffff ? "all" : object.mask.toString(2)}`]);
    rows.push(...this.nearestRows());
    if (this.gap) rows.push(["under the pointer", this.gap]);
    keepChildren(byId("selected-facts"), rows.map(([label, value, isWrong]) => [`${label}\n${value.textContent ?? value}\n${isWrong}`, () => element("tr", { class: isWrong ? "wrong" : "" }, element("th", { scope: "row" }, label), element("td", {}, value))]));
    this.showContacts(object);
  }

  showContacts(object) {
    const contacts = this.contactsOf(object.name);
    const text = `${object.name}\n${object.moving}\n${contacts.map(({ a, b, depth }) => `${a}\n${b}\n${depth}`).join("\n")}`;
    if (text === this.contactsText) return;
    this.contactsText = text;
    const mostShown = 30;
    const rows = contacts.slice(0, mostShown).map((contact) => {
      const other = contact.a === object.name ? contact.b : contact.a;
      return element("li", {}, element("span", { class: "depth" }, depthText(contact)), element("button", {
        type: "button", class: "link", onclick: () => this.on.choose(this.world.byName.get(other)?.slot ?? null),
      }, shortNameElement(other)));
    });
    if (contacts.length > mostShown) rows.push(element("li", {}, `and ${contacts.length - mostShown} more`));
    byId("selected-contacts").replaceChildren(...(rows.length ? rows : [element("li", { class: "quiet" }, object.moving ? "no contact" : "no contact with anything that moves")]));
  }
}
