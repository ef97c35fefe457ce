const kFlash_ms = 900;
const kRay_ms = 5000;
const kMarkFloats = 10;
const kMostMarks = 4000;

/// The page: connects the world, the camera and the panels, and handles what the user does.
class Page {
  constructor() {
    this.canvas = byId("scene");
    this.camera = new Camera();
    this.panels = new Panels();
    this.contacts = new Contacts();
    this.rays = [];
    this.frames = [];        // time that each of the newest pictures took, ms
    this.flashes = [];       // when each new contact was first drawn, for measurements
    this.markData = new Float32Array(kMostMarks * kMarkFloats);
    this.isDirty = true;
    this.question = 0;
    try {
      this.renderer = new Renderer(this.canvas);
    } catch (failed) {
      this.showDrawing(failed);
    }
    this.world = new World(this.renderer);
    this.canvas.addEventListener("webglcontextlost", () => this.showDrawing(new Error("the graphics card went away")));
    this.listen();
    this.setUpTheme();
    const run = byId("run");
    this.source = run ? this.openSaved(JSON.parse(run.textContent)) : new LiveSource(this.told());
    setInterval(() => this.showPanels(), 200);
    requestAnimationFrame((now) => this.draw(now));
  }

  told() {
    return {
      hello: ({ up }) => { this.camera.yIsUp = up === "y"; },
      connected: (is) => {
        this.isConnected = is;
        if (!is) this.panels.showState("the viewer is gone; looking for it", true);
      },
      status: (status) => {
        if (this.epoch !== undefined && this.epoch !== status.epoch) this.restarts = (this.restarts || 0) + 1;
        this.epoch = status.epoch;
        this.panels.showStatus(status);
      },
      silent: ({ seconds }) => this.panels.showState(`no server answers, for ${durationText(seconds)}`, true),
      table: (table, surfaceOf) => {
        this.world.setTable(table, surfaceOf);
        if (!this.camera.isTouched) this.camera.fit(this.world.bounds);
        if (this.pendingPoses) this.world.setPoses(this.pendingPoses);
        this.markContacts();
        this.isDirty = true;
      },
      poses: (frame) => {
        this.pendingPoses = frame;
        this.isDirty = true;
      },
      contacts: ({ contacts }) => {
        this.contacts.set(contacts);
        this.markContacts();
      },
      events: ({ events }) => {
        const now = performance.now();
        for (const event of events) {
          this.contacts.hear(event, now);
          if (event.what === "began") this.flashes.push({ key: `${event.a} x ${event.b}`, time: event.time, shown: null });
        }
        this.flashes = this.flashes.slice(-200);
        this.panels.addEvents(events);
        this.markContacts();
      },
      answer: (answer) => this.showAnswer(answer),
      refused: ({ id, why }) => { if (id === this.clicked) this.showText(why, ""); },
      restart: () => {
        this.contacts = new Contacts();
        this.panels.events = [];
      },
    };
  }

  openSaved(run) {
    const source = new SavedSource(run, this.told());
    byId("timeline").hidden = false;
    const slider = byId("time");
    const button = byId("play");
    slider.max = source.duration();
    const show = () => {
      slider.value = source.at;
      byId("clock").textContent = `${source.at.toFixed(1)} of ${source.duration().toFixed(1)} s`;
      button.textContent = source.isPlaying ? "pause" : "play";
    };
    slider.addEventListener("input", () => {
      source.isPlaying = false;
      source.seek(Number(slider.value)).then(show);
    });
    button.addEventListener("click", () => {
      source.isPlaying = !source.isPlaying;
      if (source.isPlaying && source.at >= source.duration()) source.seek(0);
      show();
    });
    let last = performance.now();
    setInterval(() => {
      const now = performance.now();
      if (source.isPlaying && source.isUnpacked) {
        if (source.at >= source.duration()) source.isPlaying = false;
        else source.seek(source.at + (now - last) / 1000);
      }
      last = now;
      show();
    }, 33);
    return source;
  }

  // ---- the picture

  draw(now) {
    requestAnimationFrame((next) => this.draw(next));
    if (this.hasDrawn) this.note(now - this.calledAt);
    this.calledAt = now;
    this.hasDrawn = false;
    const isFlashing = this.placeMarks(now);
    if (!(this.isDirty || isFlashing || this.world.statesChanged) || !this.renderer) return;
    this.hasDrawn = true;
    this.isDirty = false;
    if (this.pendingPoses) {
      this.world.setPoses(this.pendingPoses);
      this.pendingPoses = null;
    }
    this.world.sendStates();
    this.camera.aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    const { near, far } = this.depths();
    const grid = this.gridSize();
    const low = this.world.bounds.isEmpty() ? 0 : this.world.bounds.low[this.camera.yIsUp ? 1 : 2];
    this.renderer.draw(this.camera, { near, far, anchor: this.world.anchor, ground: low, grid });
    byId("grid").textContent = `grid ${lengthText(grid)}`;
    for (const flash of this.flashes) flash.shown = flash.shown || Date.now() / 1000;
    this.pickAtPointer();
  }

  depths() {
    const away = length(subtract(this.camera.eye(), this.world.bounds.center()));
    const radius = this.world.bounds.radius();
    const far = Math.max(this.camera.distance * 4, away + radius * 8);
    return { near: Math.max(far * 1e-5, Math.min(this.camera.distance, Math.max(away - radius * 1.5, 0)) * 0.02 + this.camera.distance * 0.002), far };
  }

  gridSize() {
    return 10 ** Math.round(Math.log10(Math.max(1e-6, this.camera.distance) / 12));
  }

  /// Takes the time of a picture, in ms. Pictures become coarser where they take too long, and finer where there is
  /// time.
  note(took) {
    if (took > 5000) return;  // the page was hidden
    this.frames.push(took);
    if (this.frames.length > 240) this.frames.shift();
    this.sinceChange = (this.sinceChange || 0) + 1;
    if (this.sinceChange < 5) return;
    const recent = this.frames.slice(-Math.min(20, this.sinceChange)).sort((a, b) => a - b);
    const median = recent[Math.floor(recent.length / 2)];
    const renderer = this.renderer;
    const finest = 2 / Math.min(2, window.devicePixelRatio || 1);
    const isSlow = median > 180 || (median > 90 && this.sinceChange >= 20);
    if (isSlow && renderer.sharpness > 0.3) renderer.sharpness *= 0.75;
    else if (median < 20 && renderer.sharpness < finest && this.sinceChange > 120) renderer.sharpness = Math.min(finest, renderer.sharpness / 0.75);
    else return;
    this.sinceChange = 0;
  }

  /// Draws contacts with their normals, and rays with their ends. Returns whether any of them is animated.
  placeMarks(now) {
    if (!this.renderer) return false;
    let count = 0;
    const anchor = this.world.anchor;
    const put = (from, to, width, kind, strength, accent) => {
      if (count >= kMostMarks) return;
      this.markData.set([...subtract(from, anchor), ...subtract(to, anchor), width, kind, strength, accent], kMarkFloats * count++);
    };
    let isFlashing = false;
    const size = this.camera.distance * this.camera.halfHeight;
    for (const { point, normal, holds, flashed } of this.contacts.pairs.values()) {
      const age = (now - flashed) / kFlash_ms;
      const flash = age >= 0 && age < 1 ? 1 - age : 0;
      if ((!holds && flash === 0) || !point || !point.every(Number.isFinite)) continue;
      isFlashing = isFlashing || flash > 0;
      const tip = add(point, scale(normal, size * (0.10 + 0.10 * flash)));
      put(point, tip, 1.5 + 2.5 * flash, 0, 1, 1);
      put(tip, tip, 5 + 4 * flash, 2, 1, 1);
      put(point, point, 9 + 34 * (flash > 0 ? age : 0), 1, Math.max(flash, 0.55), 1);
      if (flash > 0) put(point, point, 14 * flash, 2, 0.9 * flash, 1);
    }
    this.rays = this.rays.filter(({ at }) => now - at < kRay_ms);
    for (const { from, to, at, met, normal } of this.rays) {
      const left = 1 - (now - at) / kRay_ms;
      isFlashing = true;
      put(from, to, 2, 0, left, met ? 1 : 0.3);
      if (!met) continue;
      put(to, to, 7, 2, left, 1);
      put(to, add(to, scale(normal, size * 0.12)), 1.5, 0, left, 0);
    }
    if (count > 0 || this.hadMarks) this.renderer.fill(this.renderer.marks, this.markData, count);
    const isChanged = isFlashing || count !== this.hadMarks;
    this.hadMarks = count;
    return isChanged;
  }

  markContacts() {
    const slots = new Set();
    for (const { holds, a_slot, b_slot } of this.contacts.pairs.values()) {
      if (!holds) continue;
      // Static objects, such as the floor, are not coloured: they are in contact with many others.
      for (const slot of [a_slot, b_slot]) if (this.world.objects.get(slot)?.moving) slots.add(slot);
    }
    for (const slot of this.world.objects.keys()) this.world.setState(slot, kInContact, slots.has(slot));
    this.isDirty = true;
  }

  showPanels() {
    this.panels.showEvents();
    this.panels.showPublishers();
    this.panels.showMatrix(this.contacts);
  }

  /// Without WebGL: shows the drawing that the viewer makes, a new one every other second.
  showDrawing(why) {
    this.renderer = null;
    if (this.world) this.world.renderer = null;
    this.canvas.hidden = true;
    const image = byId("drawing");
    image.hidden = false;
    image.title = `${why.message}: a drawing instead`;
    const next = () => { image.src = `drawing.svg?${Date.now()}`; };
    image.onload = image.onerror = () => setTimeout(next, 2000);
    next();
  }

  // ---- what the user does

  listen() {
    const canvas = this.canvas;
    let held = null;
    const places = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      places.set(event.pointerId, event);
      held = { x: event.clientX, y: event.clientY, travelled: 0, slides: event.shiftKey || event.button !== 0 };
    });
    canvas.addEventListener("pointermove", (event) => {
      this.pointer = { x: event.clientX, y: event.clientY };
      this.isDirty = true;
      if (!held || places.size !== 1) return;
      const dx = event.clientX - held.x;
      const dy = event.clientY - held.y;
      held.travelled += Math.abs(dx) + Math.abs(dy);
      Object.assign(held, { x: event.clientX, y: event.clientY });
      if (held.travelled < 4) return;
      const unit = 1 / canvas.clientHeight;
      if (held.slides) this.camera.slide(dx * unit, dy * unit);
      else this.camera.turn(dx * unit * 3, dy * unit * 3);
    });
    canvas.addEventListener("pointerup", (event) => {
      places.delete(event.pointerId);
      if (held && held.travelled < 4 && event.button === 0) this.askAt(event.clientX, event.clientY);
      held = null;
    });
    canvas.addEventListener("pointercancel", (event) => { places.delete(event.pointerId); held = null; });
    canvas.addEventListener("pointerleave", () => { this.pointer = null; this.hover(null); });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.camera.approach(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 500))));
      this.isDirty = true;
    }, { passive: false });
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("resize", () => { this.isDirty = true; });
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, button")) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (step && event.shiftKey) this.camera.slide(-step[0] * 0.05, -step[1] * 0.05);
    else if (step) this.camera.turn(step[0] * 0.1, -step[1] * 0.1);
    else if (event.key === "+" || event.key === "=") this.camera.approach(0.85);
    else if (event.key === "-") this.camera.approach(1 / 0.85);
    else if (event.key === "f") this.camera.fit(this.world.bounds);
    else if (event.key === "t") this.setTheme(this.isNight() ? "paper" : "night");
    else if (event.key === "u") this.camera.yIsUp = !this.camera.yIsUp;
    else if (event.key === "Escape") this.choose(null);
    else return;
    event.preventDefault();
    this.isDirty = true;
  }

  isNight() {
    const theme = document.documentElement.dataset.theme;
    return theme ? theme === "night" : matchMedia("(prefers-color-scheme: dark)").matches;
  }
  setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    this.showTheme();
  }
  showTheme() {
    if (this.renderer) this.renderer.readTheme();
    this.panels.matrixText = null;
    this.isDirty = true;
  }
  setUpTheme() {
    const theme = new URLSearchParams(location.hash.slice(1)).get("theme");
    if (theme === "night" || theme === "paper") this.setTheme(theme);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.showTheme());
  }

  pickAtPointer() {
    if (!this.pointer) return;
    const box = this.canvas.getBoundingClientRect();
    const x = (this.pointer.x - box.left) / box.width;
    const y = 1 - (this.pointer.y - box.top) / box.height;
    if (x < 0 || x >= 1 || y < 0 || y >= 1) return;
    this.hover(this.renderer.pick(x, y));
  }

  hover(seen) {
    const slot = seen ? seen.slot : null;
    const object = slot === null ? null : this.world.objects.get(slot);
    if (slot !== this.hovered) {
      this.world.setState(this.hovered, kUnderPointer, false);
      this.world.setState(slot, kUnderPointer, true);
      this.hovered = slot;
      this.gap = null;
      this.askGap();
    }
    const label = byId("label");
    label.hidden = !object || !this.pointer;
    if (label.hidden) return;
    const away = document.createElement("small");
    away.textContent = `  ${lengthText(seen.range)} from the eye${this.gap ? `, ${this.gap}` : ""}`;
    label.replaceChildren(object.name, away);
    label.style.left = `${Math.min(this.pointer.x + 14, innerWidth - 240)}px`;
    label.style.top = `${Math.min(this.pointer.y + 14, innerHeight - 60)}px`;
  }

  /// Asks the server for the distance from the chosen object to the one under the pointer. One question at a time.
  askGap() {
    const [a, b] = [this.chosen, this.hovered].map((slot) => this.world.objects.get(slot));
    if (!a || !b || a === b || this.isAskingGap) return;
    this.isAskingGap = true;
    setTimeout(() => { this.isAskingGap = false; }, 250);
    this.source.ask({ ask: "pair", id: ++this.question, a: a.name, b: b.name });
  }

  choose(slot) {
    this.world.setState(this.chosen, kChosen, false);
    this.world.setState(slot, kChosen, true);
    this.chosen = slot;
    if (slot === null) byId("answer").hidden = true;
  }

  /// Asks a ray from the eye through that place. Its numbers have six digits, which is enough and can be typed again.
  askAt(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const x = (2 * (clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (clientY - box.top)) / box.height;
    const digits = Math.min(9, Math.max(0, 5 - Math.floor(Math.log10(this.camera.distance))));
    const origin = this.camera.eye().map((part) => Number(part.toFixed(digits)));
    const direction = this.camera.direction(x, y).map((part) => Number(part.toFixed(6)));
    this.clicked = ++this.question;
    this.source.ask({ ask: "ray", id: this.clicked, origin, direction });
  }

  showAnswer(answer) {
    if (answer.ask === "pair") return this.showGap(answer);
    const unit = normalized(answer.direction);
    const met = answer.answer === "hit";
    const to = met ? answer.point : add(answer.origin, scale(unit, this.camera.distance * 3));
    // It is drawn from a little beside the eye, since a line from the eye itself would look like a point.
    const { up, right } = this.camera.axes();
    const from = add(answer.origin, scale(subtract(scale(right, 0.25), up), this.camera.distance * 0.2));
    this.rays.push({ from, to, met, normal: answer.normal || unit, at: performance.now() });
    this.rays = this.rays.slice(-50);
    this.isDirty = true;
    if (answer.id !== this.clicked) return;
    this.lastAnswer = answer;
    this.choose(met ? this.world.byName.get(answer.object)?.slot ?? null : null);
    const command = `collide ray ${answer.origin.join(" ")}  ${answer.direction.join(" ")}`;
    this.showText(answerText(answer), command);
  }

  showText(text, command) {
    const box = byId("answer");
    const code = document.createElement("code");
    code.textContent = command;
    box.replaceChildren(text, code);
    box.hidden = false;
  }

  showGap(answer) {
    const [a, b] = [this.chosen, this.hovered].map((slot) => this.world.objects.get(slot)?.name);
    if (answer.a !== a || answer.b !== b) return this.askGap();
    if (answer.answer === "miss") this.gap = `${lengthText(answer.distance)} from ${answer.a}`;
    else if (answer.answer === "hit") this.gap = `${lengthText(answer.depth)} deep in ${answer.a}`;
    this.isDirty = true;
  }
}

/// As the command line writes it.
function answerText(answer) {
  if (answer.answer === "miss") return "miss  nothing along the ray";
  if (answer.answer !== "hit") return `${answer.answer}  ${answer.reason || ""}`;
  const bound = Number(answer.error).toPrecision(2);
  return `hit  ${answer.object}  distance ${answer.distance} m ±${Number(bound)}  at ${answer.point.join(" ")}  normal ${answer.normal.join(" ")}`;
}

window.collidedPage = new Page();
