const kRemembered_s = 30;
const kMostRemembered = 64 << 20;
const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 4];

/// The time shown: now, or an instant in the page's memory. Passes on to the page the state of that time, and runs the
/// bar below the picture.
///
/// show: {table({table, surfaceOf}), poses(frame), contacts(Contacts), events(events), message(kind, value),
/// goTo(event), closed() (a recording)}
class Timeline {
  constructor(show, isSaved) {
    this.show = show;
    this.isSaved = isSaved;
    this.history = isSaved ? new History(Infinity, Infinity) : new History(kRemembered_s, kMostRemembered);
    this.isLive = this.isPlaying = !isSaved;  // a saved run plays once it is unpacked
    this.speed = 1;
    this.at = 0;
    this.shownTable = null;
    this.shownFrame = null;
    this.controls();
  }

  // ---- what comes in

  now() { return performance.now() / 1000; }

  /// t: when it was received; now for live messages.
  hear(kind, value, t = this.now()) {
    const history = this.closed?.history ?? this.history;
    const isKept = ["poses", "table", "contacts", "events", "status", "standing"].includes(kind);
    if (isKept) history.add(t, kind, value);
    // While a recording is open, slots and names refer to its objects, not the server's.
    if (this.closed && !["hello", "connected"].includes(kind) && value.ask !== "memory") return;
    if (!this.isLive && (isKept || kind === "silent")) return;
    if (kind === "table") this.shownTable = value;
    if (kind === "standing") this.shownStanding = value;
    if (kind === "contacts") this.show.contacts(this.history.contactsAt(t));
    else if (kind === "events") this.show.events(value.events);
    else if (kind === "table" || kind === "poses") this.show[kind](value);
    else this.show.message(kind, value);
  }

  // ---- going through time

  begin() { return this.history.begin; }
  end() { return this.isSaved ? this.history.end : this.now(); }

  pause() {
    if (this.isLive) {
      this.isLive = false;
      this.at = this.now();
    }
    this.isPlaying = false;
    this.update();
  }
  play() {
    if (this.at >= this.end() - 0.05 && this.isSaved) this.goTo(this.begin());
    this.isPlaying = true;
    this.update();
  }
  toggle() {
    if (this.isLive || this.isPlaying) this.pause();
    else this.play();
  }
  live() {
    if (this.closed && !this.closed.isSaved) {
      Object.assign(this, this.closed);
      this.closed = null;
      this.show.closed();
    }
    if (this.isSaved) return;
    this.isLive = this.isPlaying = true;
    this.showAll(Infinity);
    this.update();
  }

  /// Shows a recording (Recordings) instead of live messages, which are kept meanwhile; live() returns to them.
  open({ entries, end }) {
    this.closed ||= { history: this.history, isSaved: this.isSaved };
    this.history = new History(Infinity, Infinity);
    for (const { t, kind, value } of entries) this.history.add(t, kind, value);
    this.history.end = end;
    this.isSaved = this.isPlaying = true;
    this.isLive = false;
    this.at = Infinity;  // the contacts shown are not those of this history
    byId("live").hidden = this.closed.isSaved;
    this.goTo(this.begin());
  }

  step(by) {
    this.pause();
    this.goTo(this.history.stepFrom(this.at, by));
  }

  /// Shows an instant, and stays there unless it plays.
  goTo(t) {
    const before = this.isLive ? Infinity : this.at;  // while it is live, `at` is the last pause
    this.isLive = false;
    this.at = Math.max(this.begin(), Math.min(this.end(), t));
    this.showAll(this.at, before);
    this.update();
  }

  /// Shows the state at t. From an instant shortly before, contacts change event by event, so that they flash.
  showAll(t, before = Infinity) {
    const table = this.history.tableAt(t);
    if (table && table.value !== this.shownTable) {
      this.shownTable = table.value;
      this.shownFrame = null;
      this.show.table({ table: structuredClone(table.value.table), surfaceOf: table.value.surfaceOf });
    }
    const frame = this.history.frameAt(t);
    if (frame && frame !== this.shownFrame) this.show.poses(frame.value);
    this.shownFrame = frame;
    if (t >= before && t - before < 1) {
      for (const { kind, value } of this.history.changesBetween(before, t)) {
        if (kind === "events") this.show.events(value.events);
        else this.show.contacts(this.history.contactsAt(t));
      }
    } else this.show.contacts(this.history.contactsAt(t));
    const standing = this.history.standingAt(t);
    if (standing !== this.shownStanding) this.show.message("standing", standing ?? { standing: [] });
    this.shownStanding = standing;
    const status = this.history.statusAt(t);
    if (status && status !== this.shownStatus) this.show.message("status", status);
    this.shownStatus = status;
  }

  /// Advances time; called for each picture.
  tick(now_ms) {
    const passed = Math.min(0.5, (now_ms - (this.tickedAt ?? now_ms)) / 1000);
    this.tickedAt = now_ms;
    if (this.isLive || !this.isPlaying) return;
    if (this.at < this.begin()) this.goTo(this.begin());
    const next = this.at + passed * this.speed;
    if (next < this.end()) this.goTo(next);
    else if (this.isSaved) {
      this.goTo(this.end());
      this.isPlaying = false;
      this.update();
    } else this.live();
  }

  eventsShown(most) { return this.history.eventsUntil(this.isLive ? Infinity : this.at, most); }

  // ---- the bar

  controls() {
    byId("timeline").hidden = false;
    byId("play").addEventListener("click", () => this.toggle());
    byId("live").addEventListener("click", () => this.live());
    byId("live").hidden = this.isSaved;
    byId("back").addEventListener("click", () => this.step(-1));
    byId("forward").addEventListener("click", () => this.step(1));
    byId("speed").append(...kSpeeds.map((speed) => element("option", { value: speed, selected: speed === 1 }, `${speed}×`)));
    byId("speed").addEventListener("change", () => {
      this.speed = Number(byId("speed").value);
      if (this.isLive && this.speed < 1) this.goTo(this.now() - 0.001);
    });
    byId("time").addEventListener("input", () => {
      this.isPlaying = false;
      this.goTo(this.begin() + (Number(byId("time").value) / 1000) * (this.end() - this.begin()));
    });
    byId("ticks").addEventListener("click", (event) => this.pressTick(event));
  }

  update() {
    const play = byId("play");
    const runs = this.isLive || this.isPlaying;
    setText(play, runs ? "❚❚" : "▶");
    if (this.shownRuns !== runs) play.setAttribute("aria-label", runs ? "Pause" : "Play");
    if (this.shownLive !== this.isLive) byId("live").setAttribute("aria-pressed", this.isLive);
    [this.shownRuns, this.shownLive] = [runs, this.isLive];
    const [begin, end] = [this.begin(), this.end()];
    const at = this.isLive ? end : this.at;
    if (document.activeElement !== byId("time") || runs) byId("time").value = String(end > begin ? (1000 * (at - begin)) / (end - begin) : 1000);
    const text = this.isSaved ? `${(at - begin).toFixed(2)} of ${(end - begin).toFixed(1)} s` : this.isLive ? "" : `${(end - at).toFixed(1)} s ago`;
    setText(byId("clock"), text);
    if (this.valueText !== text) byId("time").setAttribute("aria-valuetext", text || "now");
    this.valueText = text;
  }

  /// Draws events as ticks above the slider, once a second while time advances.
  showTicks(now) {
    this.update();
    const every_ms = 1000;
    if (now - (this.ticksAt ?? -Infinity) < every_ms) return;
    this.ticksAt = now;
    const canvas = byId("ticks");
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0) return;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    const pen = penOf(canvas);
    const style = getComputedStyle(document.documentElement);
    pen.clearRect(0, 0, width, height);
    const [begin, end] = [this.begin(), this.end()];
    const mostDrawn = 1000;
    this.ticks = this.history.eventsUntil(Infinity, mostDrawn).map(({ t, event }) => ({ t, event, x: (width * (t - begin)) / (end - begin) })).filter(({ x }) => x >= 0);
    for (const { x, event } of this.ticks) {
      const isBegin = event.what === "began";
      pen.fillStyle = style.getPropertyValue(isBegin ? "--accent" : "--quiet");
      pen.fillRect(Math.round(x), isBegin ? 0 : height / 2, 1, isBegin ? height : height / 2);
    }
  }

  pressTick(pressed) {
    const x = pressed.offsetX;
    const near = (this.ticks || []).reduce((best, tick) => (!best || Math.abs(tick.x - x) < Math.abs(best.x - x) ? tick : best), null);
    const reach_px = 12;
    if (near && Math.abs(near.x - x) <= reach_px) this.goToEvent(near.t, near.event);
  }

  /// Stops at an event and shows both of its objects; one that is no longer remembered is only shown.
  goToEvent(t, event) {
    if (t >= this.begin()) {
      this.pause();
      this.goTo(t + 1e-6);
    }
    this.show.goTo(event);
  }
}
