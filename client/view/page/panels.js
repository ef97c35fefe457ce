const byId = (id) => document.getElementById(id);

/// Rows of a table: [text, text, isWrong].
function fillTable(table, rows) {
  while (table.rows.length > rows.length) table.deleteRow(-1);
  rows.forEach(([name, value, isWrong], i) => {
    const row = table.rows[i] || table.insertRow();
    while (row.cells.length < 2) row.insertCell();
    row.cells[0].textContent = name;
    row.cells[0].title = name;
    row.cells[1].textContent = value;
    row.className = isWrong ? "wrong" : "";
  });
}

/// The panels beside the picture.
class Panels {
  constructor() {
    this.events = [];
    this.publishers = [];
    this.publishersAt = 0;
    this.rows = [];
  }

  showStatus(status) {
    byId("scenes").textContent = `${status.scenes.length ? status.scenes.join(", ") : "no scene"} · ${status.objects} objects, ${status.moving} moving`;
    this.showState(`${status.state} · world ${status.world} · collided ${status.version_text}, pid ${status.pid}`, status.state !== "ready");
    this.publishers = status.publishers;
    this.publishersAt = performance.now();
    byId("contact-count").textContent = status.contacts_truncated ? `${status.contacts}, more are not told` : `${status.contacts} hold`;
    if (status.recent) this.showRecent(status.recent);
  }

  showState(text, isWrong) {
    byId("state").textContent = text;
    byId("state").className = isWrong ? "wrong" : "";
  }

  showRecent(recent) {
    byId("step").textContent = `${rateText(recent.steps)}, ${durationText(recent.step_p50)} each`;
    const busy = recent.stages.reduce((sum, { share }) => sum + share, 0) || 1;
    const box = byId("stages");
    box.replaceChildren(...recent.stages.map(({ stage, share }) => {
      const row = document.createElement("div");
      row.className = "bar";
      const name = document.createElement("span");
      name.textContent = stage;
      const bar = document.createElement("i");
      bar.style.width = `${(100 * share) / busy}%`;
      const value = document.createElement("span");
      value.textContent = `${(100 * share).toFixed(1)} %`;
      row.append(name, bar, value);
      return row;
    }));
    const asked = recent.asked.filter(({ rate }) => rate > 0);
    byId("asked").textContent = asked.length ? "" : "nobody asks";
    fillTable(byId("kinds"), asked.map(({ kind, rate, p50, p99 }) => [`${kind}  ${rateText(rate)}`, `p50 ${durationText(p50)}  p99 ${durationText(p99)}`]));
  }

  /// Lets the ages shown grow between two statuses.
  showPublishers() {
    const since = (performance.now() - this.publishersAt) / 1000;
    const rows = this.publishers.map(({ name, silent, lost }) => {
      const age = silent + since;
      return [name, lost ? `lost, ${durationText(age)}` : durationText(age), lost || age > 2];
    });
    fillTable(byId("publishers"), rows.length > 24 ? [...rows.slice(0, 24), [`and ${rows.length - 24} more`, ""]] : rows);
  }

  addEvents(events) {
    for (const event of events) {
      if (event.what === "persisted") continue;
      this.events.unshift(event);
    }
    this.events.length = Math.min(this.events.length, 200);
    this.eventsChanged = true;
  }

  showEvents() {
    if (!this.eventsChanged) return;
    this.eventsChanged = false;
    byId("events").replaceChildren(...this.events.slice(0, 13).map((event) => {
      const item = document.createElement("li");
      item.className = event.what;
      const end = event.what === "ended" ? `  ${event.why.replace("_", " ")}` : `  ${lengthText(event.depth)} deep`;
      item.textContent = `${clockText(event.time)}  ${event.a} × ${event.b}${end}`;
      item.title = item.textContent;
      return item;
    }));
  }

  /// A matrix of objects that touch each other: those with the newest contacts.
  showMatrix(contacts) {
    const canvas = byId("matrix");
    const kMost = 14;
    const met = new Map();
    for (const contact of contacts.newest()) {
      for (const name of [contact.a, contact.b]) if (met.size < kMost && !met.has(name)) met.set(name, met.size);
    }
    const names = [...met.keys()].sort();
    const text = `${names.join("\n")}|${contacts.changes}`;
    if (text === this.matrixText) return;
    this.matrixText = text;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const cell = 13;
    const labels = 292 - cell * kMost;
    const height = Math.max(16, cell * names.length + 4);
    canvas.width = 292 * ratio;
    canvas.height = height * ratio;
    canvas.style.height = `${height}px`;
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    pen.font = "10px 'DejaVu Sans', Arial, sans-serif";
    pen.textBaseline = "middle";
    if (names.length === 0) {
      pen.fillStyle = color("--quiet");
      pen.fillText("nothing has met anything yet", 0, 8);
    }
    const place = new Map(names.map((name, i) => [name, i]));
    names.forEach((name, i) => {
      pen.fillStyle = color("--ink");
      pen.fillText(shortened(pen, name, labels - 6), 0, i * cell + cell / 2 + 1);
      pen.strokeStyle = color("--faint");
      for (let j = 0; j <= i; ++j) pen.strokeRect(labels + j * cell + 0.5, i * cell + 1.5, cell - 2, cell - 2);
    });
    for (const { a, b, holds, times } of contacts.newest()) {
      const [i, j] = [place.get(a), place.get(b)];
      if (i === undefined || j === undefined) continue;
      pen.globalAlpha = holds ? 1 : Math.min(0.75, 0.15 + 0.1 * times);
      pen.fillStyle = holds ? color("--accent") : color("--ink");
      pen.fillRect(labels + Math.min(i, j) * cell + 2, Math.max(i, j) * cell + 3, cell - 5, cell - 5);
    }
    pen.globalAlpha = 1;
  }
}

function shortened(pen, text, width) {
  if (pen.measureText(text).width <= width) return text;
  let kept = text;
  while (kept.length > 1 && pen.measureText(`…${kept}`).width > width) kept = kept.slice(1);
  return `…${kept}`;
}

/// Pairs that touch or have touched, the newest last.
class Contacts {
  constructor() {
    this.pairs = new Map();
    this.changes = 0;
  }
  key({ a, b }) { return `${a}\n${b}`; }

  /// All contacts that hold now.
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
    if (event.point) Object.assign(known, { point: event.point, normal: event.normal, depth: event.depth });
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
}
