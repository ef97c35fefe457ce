const kPanels_ms = 200;

/// The page: connects the world, the picture, the time and the panels.
class Page {
  constructor() {
    this.camera = new Camera();
    this.contacts = new Contacts();
    this.standing = new Standing();
    this.flashes = [];        // when each new contact was first drawn, for measurements
    this.chosen = this.hovered = this.followed = null;
    this.picture = new Picture(byId("scene"), byId("overlay"), { failed: (error) => this.showDrawing(error) });
    this.world = new World(this.picture.renderer);
    this.panels = new Panels();
    this.matrix = new Matrix(byId("matrix"));
    this.setUpAsking();
    this.setUpThings();
    this.setUpTime();
    this.setUpControls();
    this.setUpTheme();
    if (!this.picture.renderer) this.showDrawing(this.picture.failed);
    byId("scene").addEventListener("webglcontextlost", () => this.showDrawing(new Error("the graphics card went away")));
    setInterval(() => this.showPanels(), kPanels_ms);
    requestAnimationFrame((now) => this.draw(now));
  }

  // ---- the parts

  setUpAsking() {
    const objectOf = (slot) => this.world.objects.get(slot);
    const pick = (x, y) => this.picture.renderer?.pick((x + 1) / 2, (y + 1) / 2) ?? null;
    this.asking = new Asking(this.world, this.camera, this.picture.marks, {
      send: (question) => (this.timeline.isLive || question.ask === "memory") && this.source.ask(question),
      whyNotSent: () => this.whyNotSent(),
      chosen: () => objectOf(this.chosen),
      hovered: () => objectOf(this.hovered),
      choose: (slot) => this.choose(slot),
      drawn: () => this.changed(),
    });
    this.others = new Others(this.picture.marks, {
      ask: (question) => this.asking.ask(question),
      reach: () => 2 * this.world.bounds.radius(),
      drawn: () => this.changed(),
    });
    this.tools = new Tools(this.world, this.camera, this.picture.marks, {
      ask: (question) => this.asking.askShown(question),
      ray: (x, y) => (this.timeline.isLive ? this.asking.ray(x, y) : this.choose(pick(x, y)?.slot ?? null)),
      pick,
      choose: (slot) => this.choose(slot),
      chosen: () => objectOf(this.chosen),
      name: (slot) => objectOf(slot).name,
      drawn: () => this.changed(),
    });
  }

  setUpThings() {
    this.things = new Things(this.world, { choose: (slot) => this.choose(slot), frame: (object) => this.frame([object]), changed: () => this.changed() });
    this.selected = new Selected(this.world, {
      ask: (question) => this.asking.ask(question),
      choose: (slot) => this.choose(slot),
      frame: (object) => this.frame([object]),
      follow: (slot) => this.follow(this.followed === slot ? null : slot),
      isolate: (slot) => this.things.isolate(this.things.isolated === slot ? null : slot),
      hide: (object) => this.things.hide([object], !object.isHidden),
      nearest: (line) => this.showNearest(line),
    });
    this.selected.contactsOf = (name) => this.contacts.of(name);
    byId("color").addEventListener("input", () => this.colorObjects());
    byId("labels").addEventListener("click", () => this.toggleLabels());
    this.standingList = new StandingList({ frame: (row) => this.frameStanding(row) });
    this.events = new EventList({ goTo: (t, event) => this.timeline.goToEvent(t, event) });
  }

  setUpTime() {
    const run = byId("run");
    this.timeline = new Timeline({
      table: (value) => this.setTable(value),
      poses: (frame) => this.setPoses(frame),
      contacts: (contacts) => {
        this.contacts = contacts;
        this.markContacts();
      },
      events: (events) => this.hearEvents(events),
      message: (kind, value) => this.hear(kind, value),
      goTo: (event) => this.goToEvent(event),
      closed: () => this.showRecording(null),
    }, Boolean(run));
    this.recordings = new Recordings({
      isSaved: Boolean(run),
      ask: (question) => this.asking.ask(question),
      whyNotSent: () => this.whyNotSent(),
      opened: (recorded, name) => {
        this.camera.isTouched = false;
        this.timeline.open(recorded);
        this.showRecording(name);
      },
      say: (text) => this.asking.showAnswer([text], "", "", !text),
    });
    if (!run) {
      this.source = new LiveSource((kind, value) => this.timeline.hear(kind, value));
      return;
    }
    this.source = new SavedSource(JSON.parse(run.textContent), (t, kind, value) => {
      if (kind === "hello") this.hear(kind, value);
      else this.timeline.hear(kind, value, t);
    });
    this.source.unpack().then(() => {
      this.timeline.history.end = this.source.duration();
      this.timeline.goTo(this.timeline.begin());
      this.timeline.play();
      this.isUnpacked = true;
    });
  }

  setUpControls() {
    const canvas = byId("scene");
    const place = (x, y) => {
      const box = canvas.getBoundingClientRect();
      return [(2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height];
    };
    this.controls = new Controls(canvas, this.camera, {
      changed: () => this.changed(),
      click: (x, y) => this.tools.click(...place(x, y)),
      clickMiddle: () => this.tools.click(0, 0),
      isDragged: () => this.tools.drags(),
      beginDrag: (x, y) => this.tools.beginDrag(...place(x, y)),
      drag: (x, y) => this.tools.drag(...place(x, y)),
      endDrag: (x, y) => this.tools.endDrag(...place(x, y)),
      cancelDrag: () => this.tools.cancel(),
      point: (pointer) => {
        this.pointer = pointer;
        if (!pointer) this.hover(null);
        this.changed();
      },
    });
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("resize", () => this.fitIfUntouched());
    byId("fit").addEventListener("click", () => this.fitAll());
    byId("theme").addEventListener("click", () => this.setTheme(this.isNight() ? "paper" : "night"));
    byId("panels").addEventListener("pointerdown", () => { this.isPressed = true; });
    // A release outside the window may be missed: a pointer that returns without a button reveals it.
    for (const kind of ["pointerup", "pointercancel", "pointermove"]) window.addEventListener(kind, (event) => { this.isPressed &&= event.buttons !== 0; });
  }

  // ---- what the server says

  hear(kind, value) {
    if (kind === "hello") {
      this.camera.yIsUp = value.up === "y";
      this.asking.connection = value.connection || "";
    } else if (kind === "connected") {
      if (!value) this.panels.showState("the viewer is gone; looking for it", true);
    } else if (kind === "status") this.hearStatus(value);
    else if (kind === "standing") {
      this.standing.set(value.standing);
      this.changed();
    } else if (kind === "silent") this.panels.showState(`no server answers, for ${durationText(value.seconds)}`, true);
    else if (kind === "answer") this.hearAnswer(value);
    else if (kind === "refused") {
      this.recordings.refused(value);
      this.others.refused(value);
      this.asking.refused(value);
    }
  }

  hearStatus(status) {
    if (this.epoch !== undefined && this.epoch !== status.epoch) this.restarts = (this.restarts || 0) + 1;
    this.epoch = status.epoch;
    this.panels.showStatus(status, performance.now());
  }

  hearAnswer(answer) {
    if (answer.ask === "object") this.selected.hear(answer);
    else if (answer.ask === "sampled") this.others.hear(answer, performance.now());
    else if (answer.ask === "memory") this.recordings.hear(answer);
    else if (answer.ask === "nearest") this.selected.hearNearest(answer);
    else if (answer.ask === "owners") {
      this.things.setOwners(answer.owners);
      this.colorObjects();
    } else this.asking.hear(answer);
    this.selected.gap = this.asking.gap;
  }

  setTable({ table, surfaceOf }) {
    const name = this.world.objects.get(this.chosen)?.name;
    this.world.setTable(table, surfaceOf);
    this.fitIfUntouched();
    if (this.pendingPoses) this.world.setPoses(this.pendingPoses);
    this.choose(this.world.byName.get(name)?.slot ?? null);
    if (this.followed !== null) this.follow(this.world.byName.has(name) ? this.chosen : null);
    if (this.things.isolated !== undefined && this.things.isolated !== null) this.things.isolate(this.chosen);
    this.things.build();
    this.colorObjects();
    this.markContacts();
    this.askOwners();
  }

  /// Asks which publisher moves which objects, at most every other second: that is enough even if objects come and go
  /// all the time.
  askOwners() {
    if (this.ownersTimer) return;
    this.ownersTimer = setTimeout(() => {
      this.ownersTimer = null;
      this.asking.ask({ ask: "owners" });
    }, this.ownersAsked ? 2000 : 100);
    this.ownersAsked = true;
  }

  showRecording(name) {
    byId("recording").hidden = name === null;
    if (name !== null) byId("recording").replaceChildren("recording: ", nameElement(name));
  }

  /// The text shown instead of an answer; the server answers about now, not about the past.
  whyNotSent() {
    return this.source.whyGone() || (this.timeline.closed ? "a recording is shown: no server answers about it" : "the past is shown, and the server answers about now: press live");
  }

  setPoses(frame) {
    this.pendingPoses = frame;
    this.changed();
  }

  hearEvents(events) {
    const now = performance.now();
    for (const event of events) {
      this.contacts.hear(event, now);
      if (event.what === "began") this.flashes.push({ key: `${event.a} x ${event.b}`, time: event.time, shown: null });
    }
    this.flashes = this.flashes.slice(-200);
    this.markContacts();
  }

  markContacts() {
    const touching = new Set();
    const doubtful = new Set();
    for (const { holds, doubt, a_slot, b_slot } of this.contacts.pairs.values()) {
      if (!holds) continue;
      // Static objects, such as the floor, are not coloured: they are in contact with many others.
      for (const slot of [a_slot, b_slot]) if (this.world.objects.get(slot)?.moving) (doubt ? doubtful : touching).add(slot);
    }
    for (const slot of this.world.objects.keys()) {
      this.world.setState(slot, kInContact, touching.has(slot));
      this.world.setState(slot, kInDoubt, doubtful.has(slot));
    }
    this.changed();
  }

  // ---- the picture

  changed() { this.picture.isDirty = true; }

  draw(now) {
    requestAnimationFrame((next) => this.draw(next));
    this.timeline.tick(now);
    this.selected.tickNearest(now, this.timeline.isLive);
    this.others.tick(now, this.timeline.isLive);
    if (this.pendingPoses) this.applyPoses();
    const isDrawn = this.picture.draw(now, {
      world: this.world, camera: this.camera, contacts: this.contacts, standing: this.standing,
      isShown: ({ a_slot, b_slot }) => !this.world.hasState(a_slot, kHidden) && !this.world.hasState(b_slot, kHidden),
      labelled: () => this.labelled(),
    });
    if (!isDrawn) return;
    for (const flash of this.flashes) flash.shown = flash.shown || Date.now() / 1000;
    this.pickAtPointer();
  }

  applyPoses() {
    const followed = this.world.objects.get(this.followed);
    const before = followed && [...followed.position];
    this.world.setPoses(this.pendingPoses);
    this.pendingPoses = null;
    if (before) this.camera.target = add(this.camera.target, subtract(followed.position, before));
  }

  /// The objects named in the picture: the chosen one, and with labels the moving ones, then the rest, large ones
  /// first.
  labelled() {
    const chosen = this.world.objects.get(this.chosen);
    const first = chosen ? [chosen] : [];
    if (!this.picture.labels.areShown) return first;
    if (this.labelOrderOf !== this.world.version) {
      this.labelOrderOf = this.world.version;
      const size = (object) => (object.own.isEmpty() ? 0 : object.own.radius());
      const mostConsidered = 2000;
      this.labelOrder = [...this.world.objects.values()].sort((a, b) => b.moving - a.moving || size(b) - size(a)).slice(0, mostConsidered);
    }
    return [...first, ...this.labelOrder.filter((object) => object !== chosen && !object.isHidden && !this.world.hasState(object.slot, kFaint))];
  }

  /// A click is lost if the pressed element is rebuilt before the release, so the panels do not change meanwhile.
  showPanels() {
    if (this.isPressed) return;
    const now = performance.now();
    this.events.show(this.timeline);
    this.panels.showPublishers(this.timeline.isLive ? now : null);
    this.standingList.show(this.standing);
    this.matrix.show(this.contacts, now);
    this.things.showRows();
    this.openShells(now);
    this.selected.tick(now, this.timeline.isLive);
    this.timeline.showTicks(now);
    const quality = byId("quality");
    setText(quality, this.picture.qualityText());
    quality.classList.toggle("coarse", this.picture.isCoarse());
    setText(byId("grid"), this.picture.grid ? `grid ${lengthText(this.picture.grid)}` : "");
  }

  openShells(now) {
    const every_ms = 1000;
    if (now - (this.openedAt ?? -Infinity) < every_ms) return;
    this.openedAt = now;
    this.world.openShells();
    this.world.levelMovers();
    if (byId("color").value === "age") this.colorObjects();
  }

  /// Without WebGL: shows the drawing that the viewer makes, a new one every other second.
  showDrawing(why) {
    this.picture.renderer = null;
    this.world.renderer = null;
    byId("scene").hidden = true;
    byId("overlay").hidden = true;
    const image = byId("drawing");
    image.hidden = false;
    image.title = `${why.message}: a drawing instead`;
    const next = () => { image.src = `drawing.svg?${Date.now()}`; };
    image.onload = image.onerror = () => setTimeout(next, 2000);
    next();
  }

  // ---- what the user does

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, select, textarea")) return;
    const keys = {
      "+": () => this.camera.approach(0.85),
      "=": () => this.camera.approach(0.85),
      "-": () => this.camera.approach(1 / 0.85),
      f: () => this.fitAll(),
      t: () => this.setTheme(this.isNight() ? "paper" : "night"),
      u: () => { this.camera.yIsUp = !this.camera.yIsUp; },
      l: () => this.toggleLabels(),
      p: () => this.timeline.toggle(),
      ",": () => this.timeline.step(-1),
      ".": () => this.timeline.step(1),
      "/": () => this.openSearch(),
      "?": () => this.toggleHelp(),
      Escape: () => this.escape(),
    };
    const tool = kTools[Number(event.key) - 1];
    const action = tool ? () => this.tools.take(tool) : keys[event.key];
    if (!action || (event.target.matches("button, summary") && event.key === " ")) return;
    action();
    event.preventDefault();
    this.changed();
  }
  escape() {
    this.tools.cancel();
    this.asking.hideAnswer();
    this.panels.closeSheet();
    this.choose(null);
  }
  openSearch() {
    byId("panel-things").open = true;
    byId("search").focus();
  }
  toggleHelp() {
    const help = byId("panel-help");
    help.open = !help.open;
    if (help.open) help.scrollIntoView({ block: "nearest" });
  }

  isNight() {
    const theme = document.documentElement.dataset.theme;
    return theme ? theme === "night" : matchMedia("(prefers-color-scheme: dark)").matches;
  }
  setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    remembered.set("theme", theme);
    this.showTheme();
  }
  showTheme() {
    if (this.picture.renderer) this.picture.renderer.readTheme();
    this.matrix.forget();
    this.changed();
  }
  setUpTheme() {
    const theme = new URLSearchParams(location.hash.slice(1)).get("theme") || remembered.get("theme", null);
    if (theme === "night" || theme === "paper") document.documentElement.dataset.theme = theme;
    this.showTheme();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.showTheme());
  }

  fitIfUntouched() {
    if (!this.camera.isTouched) this.fitAll();
    this.changed();
  }
  fitAll() {
    const [width, height] = this.picture.size();
    this.camera.aspect = width / height;
    const over = (id) => (byId(id).getBoundingClientRect().height + 12) / height;
    this.camera.fit(this.world.bounds, over("title"), over("timeline"));
    this.camera.isTouched = false;
    this.changed();
  }
  /// Centres some objects, at a distance that also shows their surroundings.
  frame(objects) {
    const bounds = new Bounds();
    for (const object of objects.filter((one) => one && !one.own.isEmpty())) {
      const placed = placedBounds(object);
      const reach = Math.min(placed.radius(), this.world.bounds.radius() * 0.2);
      bounds.extend(object === objects[0] || placed.radius() <= reach ? placed.center() : bounds.center(), reach);
    }
    if (bounds.isEmpty()) return;
    this.camera.target = bounds.center();
    this.camera.distance = Math.max(1e-3, 5 * bounds.radius());
    this.camera.isTouched = true;
    this.changed();
  }
  frameStanding(row) {
    const bounds = this.standing.bounds(row, this.world);
    if (bounds.isEmpty()) return;
    this.camera.target = bounds.center();
    this.camera.distance = Math.max(1e-3, 3 * bounds.radius());
    this.camera.isTouched = true;
    this.changed();
  }
  goToEvent(event) {
    const [a, b] = [this.world.byName.get(event.a), this.world.byName.get(event.b)];
    const [small, large] = [a, b].filter(Boolean).sort((one, other) => one.own.radius() - other.own.radius());
    if (!small) return;
    this.choose(small.slot);
    this.frame([small, large].filter((one) => one && one.own.radius() <= 4 * small.own.radius()));
  }

  showNearest(line) {
    if (!line && !this.picture.marks.nearest) return;
    this.picture.marks.nearest = line;
    this.changed();
  }
  follow(slot) {
    this.followed = slot;
    byId("follow").setAttribute("aria-pressed", slot !== null);
  }
  toggleLabels() {
    this.picture.labels.areShown = !this.picture.labels.areShown;
    byId("labels").setAttribute("aria-pressed", this.picture.labels.areShown);
    this.changed();
  }
  colorObjects() {
    const { colorOf, legend } = coloring(byId("color").value, this.world);
    this.world.tint(colorOf);
    keepChildren(byId("color-legend"), legend.map(([color, text]) => [`${color} ${text}`, () => {
      const mark = element("i");
      mark.style.background = `rgb(${color.join()})`;
      return element("li", {}, mark, nameElement(text));
    }]));
    this.changed();
  }

  choose(slot) {
    this.world.setState(this.chosen, kChosen, false);
    this.world.setState(slot, kChosen, true);
    const isNew = slot !== this.chosen;
    this.chosen = slot;
    if (isNew) {
      this.asking.forgetGap();
      this.selected.gap = null;
      if (this.followed !== null && this.followed !== slot) this.follow(null);
      if (this.things.isolated !== undefined && this.things.isolated !== null && slot === null) this.things.isolate(null);
      this.selected.choose(slot);
      this.things.setChosen(slot);
    }
    this.changed();
  }

  pickAtPointer() {
    if (!this.pointer) return;
    const box = byId("scene").getBoundingClientRect();
    const x = (this.pointer.x - box.left) / box.width;
    const y = 1 - (this.pointer.y - box.top) / box.height;
    if (x < 0 || x >= 1 || y < 0 || y >= 1) return this.hover(null);
    this.hover(this.picture.renderer.pick(x, y), box);
  }

  hover(seen, box) {
    const slot = seen ? seen.slot : null;
    const object = slot === null ? null : this.world.objects.get(slot);
    if (slot !== this.hovered) {
      this.world.setState(this.hovered, kUnderPointer, false);
      this.world.setState(slot, kUnderPointer, true);
      this.hovered = slot;
      this.asking.forgetGap();
      this.selected.gap = null;
    }
    if (object && this.timeline.isLive) this.asking.askGap();
    const label = byId("label");
    label.hidden = !object || !this.pointer;
    if (label.hidden) return;
    const away = element("small", {}, `${lengthText(seen.range)} from the eye${this.asking.gap ? `, ${this.asking.gap}` : ""}`);
    label.replaceChildren(nameElement(object.name), " ", away);
    // Next to the pointer, but never outside the picture, where panels are.
    const [wide, high] = [label.offsetWidth, label.offsetHeight];
    const right = box.right - wide - 4;
    const x = this.pointer.x + 14;
    label.style.left = `${Math.max(box.left + 4, x > right ? Math.min(right, this.pointer.x - wide - 10) : x)}px`;
    const y = this.pointer.y + 14;
    label.style.top = `${Math.max(box.top + 4, y + high > box.bottom - 4 ? this.pointer.y - high - 10 : y)}px`;
  }
}

window.collidedPage = new Page();
