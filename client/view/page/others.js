const kOtherShown_ms = 1500;
const kOthersEvery_ms = 250;

/// A sample of other clients' questions, as faint marks that fade. Off by default: the server samples only on request.
class Others {
  /// on: {ask(question) -> its number, null if there is no connection; reach() -> metres that a ray is drawn; drawn()}
  constructor(marks, on) {
    this.marks = marks;
    this.on = on;
    this.since = 0;
    this.switch = byId("others");
    this.switch.addEventListener("change", () => {
      this.waitsFor = null;
      this.tell("");
    });
  }
  tell(text) { setText(byId("others-note"), text); }

  /// Called for each picture. One question at a time, and a new one if there is no answer.
  tick(now, isLive) {
    if (!this.switch.checked || !isLive) return this.forget();
    const patience_ms = 2000;
    if (now - (this.askedAt ?? -Infinity) < (this.waitsFor ? patience_ms : kOthersEvery_ms)) return;
    this.askedAt = now;
    this.waitsFor = this.on.ask({ ask: "sampled", since: this.since });
  }
  forget() {
    if (this.marks.others.length === 0) return;
    this.marks.others = [];
    this.on.drawn();
  }

  hear({ id, questions, since }, now) {
    if (id !== this.waitsFor) return;
    this.waitsFor = null;
    this.since = since;
    for (const question of questions) {
      const at = now - question.ago_ns / 1e6;
      if (now - at < kOtherShown_ms && this.switch.checked) this.marks.others.push({ pieces: this.pieces(question), at });
    }
    if (questions.length) this.on.drawn();
  }
  refused({ id, why }) {
    if (id !== this.waitsFor) return;
    this.waitsFor = null;
    this.switch.checked = false;
    this.tell(why);
  }

  /// As for the page's own questions, with fewer lines.
  pieces({ kind, origin, direction, length: long, center, radius, half, orientation, point, answer, at }) {
    const isThere = (place) => place && place.every(Number.isFinite);
    const met = isThere(at) ? [dotAt(at, 4)] : [];
    if (answer === "invalid") return [];
    if (kind === "ray") {
      const end = isThere(at) ? at : add(origin, scale(normalized(direction), Math.min(long ?? Infinity, this.on.reach())));
      return [line(origin, end, 1, answer === "miss" ? 0.3 : 1), dotAt(origin, 3, 0), ...met];
    }
    if (kind === "sphere") return [...ballPieces(center, radius, 16), ...met];
    if (kind === "box") return [...boxPieces(center, half, orientation), ...met];
    return [dotAt(point, 4, 0), ...(met.length ? [line(point, at, 1), ...met] : [])];
  }
}
