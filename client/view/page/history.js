/// The messages of the last seconds, so that any instant of them can be shown again. Bounded in time and bytes.
class History {
  constructor(most_s, mostBytes) {
    this.most_s = most_s;
    this.mostBytes = mostBytes;
    this.clear();
  }

  clear() {
    this.frames = [];   // {t, value}: poses of all moving objects
    this.tables = [];   // {t, value}
    this.changes = [];  // {t, kind, value}: contacts and events, in order
    this.standing = []; // {t, value}
    this.others = [];   // {t, kind, value}: status and similar, the newest of each kind is valid
    this.base = new Contacts();  // before the first change
    this.bytes = 0;
    this.end = 0;
    this.trimmedAt = this.most_s < Infinity ? -Infinity : Infinity;
  }
  get begin() { return this.frames.length ? Math.max(this.frames[0].t, this.end - this.most_s) : this.end; }

  add(t, kind, value) {
    this.end = Math.max(this.end, t);
    if (kind === "poses") {
      this.frames.push({ t, value });
      this.bytes += value.numbers.buffer.byteLength;
    } else if (kind === "table") this.tables.push({ t, value });
    else if (kind === "standing") this.standing.push({ t, value });
    else if (kind === "contacts" || kind === "events") this.changes.push({ t, kind, value });
    else this.others.push({ t, kind, value });
    if (this.end - this.trimmedAt > 1 || this.bytes > this.mostBytes) this.trim();
  }

  /// Removes entries that are too old, even if nothing moves, and frames beyond the limit of bytes. Of values that hold
  /// until they are replaced, including poses, the last one before the beginning stays.
  trim() {
    this.trimmedAt = this.end;
    let kept = Math.max(0, firstAfter(this.frames, this.end - this.most_s) - 1);
    let bytes = this.frames.slice(kept).reduce((sum, { value }) => sum + value.numbers.buffer.byteLength, 0);
    while (bytes > 0.9 * this.mostBytes && kept < this.frames.length - 1) bytes -= this.frames[kept++].value.numbers.buffer.byteLength;
    this.frames.splice(0, kept);
    this.bytes = bytes;
    const begin = this.frames.length ? this.begin : this.end - this.most_s;
    this.tables.splice(0, Math.max(0, firstAfter(this.tables, begin) - 1));
    this.others.splice(0, Math.max(0, firstAfter(this.others, begin) - 1));
    this.standing.splice(0, Math.max(0, firstAfter(this.standing, begin) - 1));
    for (const change of this.changes.splice(0, firstAfter(this.changes, begin))) applyChange(this.base, change);
  }

  /// The frame at an instant; null before the first.
  frameAt(t) { return this.frames[firstAfter(this.frames, t) - 1] || null; }
  tableAt(t) { return this.tables[firstAfter(this.tables, t) - 1] || null; }
  standingAt(t) { return this.standing[firstAfter(this.standing, t) - 1]?.value ?? null; }
  statusAt(t) {
    for (let i = firstAfter(this.others, t) - 1; i >= 0; --i) if (this.others[i].kind === "status") return this.others[i].value;
    return null;
  }
  contactsAt(t) {
    const contacts = this.base.copy();
    for (const change of this.changes.slice(0, firstAfter(this.changes, t))) applyChange(contacts, change);
    return contacts;
  }
  changesBetween(after, until) { return this.changes.slice(firstAfter(this.changes, after), firstAfter(this.changes, until)); }

  /// Events until an instant, newest first, at most `most`: [{t, event}].
  eventsUntil(t, most) {
    const found = [];
    for (let i = firstAfter(this.changes, t) - 1; i >= 0 && found.length < most; --i) {
      if (this.changes[i].kind !== "events") continue;
      const { events } = this.changes[i].value;
      for (let k = events.length - 1; k >= 0 && found.length < most; --k) if (events[k].what !== "persisted") found.push({ t: this.changes[i].t, event: events[k] });
    }
    return found;
  }

  /// The instant of the frame before or after another one.
  stepFrom(t, by) {
    const at = firstAfter(this.frames, t) - 1 + by;
    return this.frames[Math.max(0, Math.min(this.frames.length - 1, at))]?.t ?? t;
  }
}

/// The number of entries until t, by bisection: they are ordered by time.
function firstAfter(entries, t) {
  let low = 0;
  let high = entries.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (entries[middle].t <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

function applyChange(contacts, { kind, value }) {
  if (kind === "contacts") contacts.set(value.contacts);
  else for (const event of value.events) contacts.hear(event, -Infinity);
}
