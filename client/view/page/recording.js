// Recordings: MCAP files (https://mcap.dev/spec, version 0) that `collide record` or the server's flight recorder has written.
const kFrameBytes = 33;  // of an object in History
const kMostHistoryBytes = 256e6;

/// Calls hear(type, topic, t, view) with each message: the name of its type without a module, seconds since 1970, its bytes;
/// and note(name, entries) with metadata. Returns what is wrong with the file, empty where nothing is. Throws where it is no
/// MCAP file.
function readMcap(buffer, hear, note = () => {}) {
  const whole = new DataView(buffer);
  const magic = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
  if (buffer.byteLength < 8 || magic.some((byte, i) => whole.getUint8(i) !== byte)) throw new Error("this is no MCAP file");
  const schemas = new Map();
  const channels = new Map();
  let compressed = 0;
  const text = (view, at) => [new TextDecoder().decode(new Uint8Array(view.buffer, view.byteOffset + at + 4, view.getUint32(at, true))), at + 4 + view.getUint32(at, true)];
  const record = {
    3: (view) => schemas.set(view.getUint16(0, true), text(view, 2)[0].split("::").at(-1)),
    4: (view) => channels.set(view.getUint16(0, true), { type: schemas.get(view.getUint16(2, true)), topic: text(view, 4)[0] }),
    5: (view) => {
      const channel = channels.get(view.getUint16(0, true));
      if (channel) hear(channel.type, channel.topic, wideNumber(view, 6) / 1e9, new DataView(view.buffer, view.byteOffset + 22, view.byteLength - 22));
    },
    6: (view) => {
      const [compression, after] = text(view, 28);
      if (compression) ++compressed;
      else records(new DataView(view.buffer, view.byteOffset + after + 8, wideNumber(view, after)));
    },
    12: (view) => {
      const [name, list] = text(view, 0);
      const entries = {};
      for (let at = list + 4; at < view.byteLength;) {
        const [key, value] = text(view, at);
        [entries[key], at] = text(view, value);
      }
      note(name, entries);
    },
  };
  const records = (view) => {
    let at = 0;
    while (at + 9 <= view.byteLength) {
      const bytes = wideNumber(view, at + 1);
      if (at + 9 + bytes > view.byteLength) return false;
      record[view.getUint8(at)]?.(new DataView(view.buffer, view.byteOffset + at + 9, bytes));
      at += 9 + bytes;
    }
    return true;
  };
  const isWhole = records(new DataView(buffer, 8));
  if (compressed) return `${countText(compressed)} chunks are compressed and left out`;
  return isWhole || buffer.byteLength < 17 ? "" : "the file breaks off";
}

// Offsets in a sample, behind five numbers, of the code of its question or answer and of its request number.
const kCodeAt = 4 + 28;
const requestOf = (view) => [4, 12].map((at) => wideNumber(view, at)).join(" ");
const codeOf = (view) => (view.byteLength > kCodeAt ? view.getUint8(kCodeAt) : null);
const isCommand = (type, view) => type === "Query" && kQuestionKind[codeOf(view)] === "command";

const jsonOf = (view) => JSON.parse(new TextDecoder().decode(view));

/// A recording as the page would have heard it: entries for History, in seconds from its beginning.
class RecordedRun {
  /// surroundings: {objects, surfaceOf}: what stands still and is in no recording, such as the server's scenes
  constructor(buffer, surroundings) {
    this.surroundings = surroundings;
    this.objects = new Map();  // by "publisher number", or by name for what commands added
    this.slots = new Map();    // by name
    this.surfaces = new Map();
    this.entries = [];         // {t, kind, value}
    this.shards = new Map();
    this.broken = 0;
    this.waiting = new Map();   // commands without an answer yet, by client and request
    this.gone = new Set();      // names of surroundings that commands removed
    this.attached = new Map();  // by the child's name: {parent, pose (in the parent's frame)}
    this.lost = new Set();      // publishers
    const span = this.measure(buffer);
    this.refused = span.refused;
    this.openingLeft = span.opening;
    this.begin = span.begin;
    this.every_s = Math.max(1 / 60, ((span.end - span.begin) * span.movers * kFrameBytes) / kMostHistoryBytes);
    this.frameAt = this.tableAt = -Infinity;
    this.damage = readMcap(buffer, (type, topic, t, view) => this.hear(type, topic, t - this.begin, view));
    this.end = span.end - span.begin;
    this.flush(this.end);
    this.tellContacts();
  }

  measure(buffer) {
    const span = { begin: Infinity, end: -Infinity, movers: 0, opening: 0, refused: new Set() };
    readMcap(buffer, (type, _, t, view) => {
      span.begin = Math.min(span.begin, t);
      span.end = Math.max(span.end, t);
      if (type === "Definition" || isCommand(type, view)) ++span.movers;
      if (type === "Reply" && kReplyStatus[codeOf(view)] === "refused") span.refused.add(requestOf(view));
    }, (name, entries) => {
      if (name === "recording") span.opening = Number(entries.opening_messages ?? 0);
    });
    if (!(span.end >= span.begin)) throw new Error("the recording has no messages");
    return span;
  }

  hear(type, topic, t, view) {
    this.isOpening = this.openingLeft-- > 0;
    if (type === "Query" && !isCommand(type, view)) return;
    if (type === "Reply" && (codeOf(view) === null || !this.waiting.has(requestOf(view)))) return;
    const hearing = { Definition: this.define, PoseBatch: this.pose, Query: this.command, Reply: this.answer, EventFrame: this.happen, ContactShard: this.hold, Status: this.state, "collided.Standing": this.stand }[type];
    if (!hearing || (type === "Status" && /step/.test(topic)) || (type === "EventFrame" && /persisted/.test(topic))) return;
    if (t - this.frameAt >= this.every_s) this.flush(t);
    try {
      hearing.call(this, type === "collided.Standing" ? jsonOf(view) : readSample(type, view), t);
    } catch {
      ++this.broken;  // bytes of another version, or damaged ones
    }
  }

  // ---- what is there

  define({ publisher, object_number, publisher_name, name, removed, moving, lost_policy, layers, mask, group, position, orientation, shape }) {
    const key = `${publisher} ${object_number}`;
    if (removed) this.objects.delete(key);
    else if (shape.length === 0) {
      // It claims what is there already.
      const claimed = [...this.objects].find(([, object]) => object.name === name);
      if (!claimed) return;
      this.objects.delete(claimed[0]);
      this.objects.set(key, { ...claimed[1], publisher: publisher_name });
    } else this.add(key, { name, moving: Boolean(moving), layers, mask, group, publisher: publisher_name, by: publisher, lostPolicy: kLostPolicy[lost_policy & ~kPolicyEntersWithInstant], pose: [...position, ...orientation] }, shape);
    this.isTableNew = true;
  }

  add(key, object, bytes, scale) {
    const { parts, meshes } = readShape(bytes, scale);
    this.gone.delete(object.name);
    const runs = meshes.map((surface) => {
      const number = `recorded ${this.surfaces.size}`;
      this.surfaces.set(number, surface);
      return [number, 0, surface.corners.length / 3];
    });
    this.objects.set(key, { scene: "", stale: false, ...object, slot: this.slotOf(object.name), parts, runs });
  }
  slotOf(name) {
    if (!this.slots.has(name)) this.slots.set(name, this.slots.size);
    return this.slots.get(name);
  }

  pose({ publisher, object_numbers, positions, orientations, source_time_ns }) {
    if (source_time_ns > 0) this.worldTime = source_time_ns / 1e9;
    object_numbers.forEach((number, i) => {
      const object = this.objects.get(`${publisher} ${number}`);
      if (!object) return;
      object.pose = [...positions.subarray(3 * i, 3 * i + 3), ...orientations.subarray(4 * i, 4 * i + 4)];
      object.stale = false;
      this.arePosesNew = true;
    });
  }

  /// A command counts from its answer on, which says what it did; a refused one, and one without an answer, not at all. Those
  /// of the opening, and those that a server gave itself, have no answers.
  command({ client, request, text, blob }) {
    const key = `${client} ${request}`;
    const command = JSON.parse(text);
    if (this.isOpening || client === 0) {
      if (!this.refused.has(key)) this.carryOut(command, blob, {});
    } else this.waiting.set(key, { command, blob, texts: [] });
  }
  answer({ client, request, chunk_index, chunk_count, status, text }) {
    const key = `${client} ${request}`;
    const asked = this.waiting.get(key);
    if (kReplyStatus[status] === "progress") return;
    if (kReplyStatus[status] === "refused") return this.waiting.delete(key);
    asked.texts[chunk_index] = text;
    if (Object.keys(asked.texts).length < chunk_count) return;
    this.waiting.delete(key);
    const decoder = new TextDecoder();
    this.carryOut(asked.command, asked.blob, JSON.parse(asked.texts.map((part) => decoder.decode(part, { stream: true })).join("")));
  }

  carryOut(command, blob, answer) {
    const { name } = command;
    const carried = {
      add: ({ pose = [0, 0, 0, 1, 0, 0, 0], moving = true, layers = 1, mask = 0xffffffff, group = 0, scale }) => this.add(name, { name, moving, layers, mask, group, publisher: "", pose }, blob, scale),
      move: ({ pose }) => {
        this.attached.delete(name);
        Object.assign(this.objects.get(name) ?? this.recordedAs(name) ?? {}, { pose });
      },
      remove: () => this.remove(answer.removed ?? this.named(name)),
      clear: ({ scene = "", moving = false }) => this.clear(scene, moving),
      load: () => { for (const one of this.surroundings.objects) if (one.scene === answer.scene) this.gone.delete(one.name); },
      attach: ({ child, parent, pose }) => this.attached.set(child, { parent, pose: answer.pose ?? pose }),
      detach: ({ child }) => this.detach(child),
    }[command.command];
    if (!carried) return;
    carried(command);
    this.isTableNew = this.isTableNew || command.command !== "move";
    this.arePosesNew = true;
  }

  recordedAs(wanted) { return [...this.objects.values()].find(({ name }) => name === wanted); }
  all() { return [...this.surroundings.objects, ...this.objects.values()]; }
  /// The names that a removal is about: an object's own, or a glob.
  named(glob) {
    const names = this.all().map(({ name }) => name);
    if (names.includes(glob) || !isGlob(glob)) return [glob];
    const expression = new RegExp(globExpression(glob).source, "su");  // the server's globs tell upper from lower case
    return names.filter((name) => expression.test(name));
  }
  remove(names) {
    const removed = new Set(names);
    for (const [child, { parent }] of this.attached) if (removed.has(child) || removed.has(parent)) this.detach(child);
    for (const [key, { name }] of this.objects) if (removed.has(name)) this.objects.delete(key);
    for (const name of names) this.gone.add(name);
  }
  /// Removes scenes, and what no living publisher has.
  clear(scene, isMovingOnly) {
    const areOthers = !scene || isMovingOnly;
    const isGone = (one) => (one.scene ? (scene ? one.scene === scene : !isMovingOnly) : areOthers && (one.moving || !isMovingOnly) && (!one.by || this.lost.has(one.by)));
    this.remove(this.all().filter(isGone).map(({ name }) => name));
  }
  detach(child) {
    const object = this.recordedAs(child);
    if (object) object.pose = this.poseOf(object);
    this.attached.delete(child);
  }
  /// Where an object is: what is attached goes along with its parent.
  poseOf(object, depth = 0) {
    const { parent, pose } = this.attached.get(object.name) ?? {};
    const carrier = pose && depth < 16 && this.all().find(({ name }) => name === parent);
    if (!carrier) return object.pose;
    const [x, y, z, ...turn] = this.poseOf(carrier, depth + 1);
    return [...add([x, y, z], rotate(turn, pose.slice(0, 3))), ...multiplied(turn, pose.slice(3))];
  }
  /// Applies the lost policy to a publisher's objects: they leave, or stay where they were, stale or as if known.
  lose(publisher) {
    if (this.lost.has(publisher)) return;
    this.lost.add(publisher);
    for (const [key, object] of this.objects) {
      if (object.by !== publisher) continue;
      if (object.lostPolicy === "remove") this.objects.delete(key);
      else object.stale = object.lostPolicy === "freeze";
      this.isTableNew = this.arePosesNew = true;
    }
  }

  // ---- what happened

  happen(frame, t) {
    this.tellContacts();
    const nameOf = namesOf(frame);
    const events = Array.from(frame.kinds, (kind, i) => {
      const what = kEventKind[kind];
      const isWithinNow = what !== "began" && what !== "emerged";  // of these the codes are about the event after, or the time before
      const event = { what, ...this.pair(frame, i, nameOf, isWithinNow), sequence: frame.first_sequence + i, episode: frame.episodes[i], time: frame.world_time_ns / 1e9 - (frame.bracket_highs[i] || 0) };
      if (what === "ended") Object.assign(event, { why: kEndReason[frame.reasons[i]] ?? "" });
      return event;
    });
    if (events.length) this.entries.push({ t, kind: "events", value: { events, left_out: 0 } });
  }
  hold(shard) {
    if (this.shards) this.shards.set(shard.shard, shard);
  }
  /// The contacts that held before the first event.
  tellContacts() {
    if (!this.shards) return;
    const contacts = [...this.shards.values()].flatMap((shard) => {
      const nameOf = namesOf(shard);
      return Array.from(shard.a, (_, i) => ({ what: "open", ...this.pair(shard, i, nameOf), time: shard.began_ns[i] / 1e9, episode: shard.episodes[i] }));
    });
    this.entries.unshift({ t: 0, kind: "contacts", value: { contacts, left_out: 0 } });
    this.shards = null;
  }
  pair(columns, i, nameOf, isWithinNow = true) {
    const [a, b] = [nameOf.get(columns.a[i]) ?? "?", nameOf.get(columns.b[i]) ?? "?"];
    const vector = (of) => [...columns[of].subarray(3 * i, 3 * i + 3)];
    const told = columns.points.length > 3 * i ? { point: vector("points"), normal: vector("normals"), depth: columns.depths[i], error: columns.depth_errors[i] } : {};
    const contained = columns.a_triangles[i] === kTriangleWithin ? "a" : columns.b_triangles[i] === kTriangleWithin ? "b" : null;
    return { a, b, a_slot: this.slotOf(a), b_slot: this.slotOf(b), ...told, ...(columns.doubts[i] ? { doubt: kDoubt[columns.doubts[i]] ?? "numeric" } : {}), ...(isWithinNow && contained ? { contained } : {}) };
  }

  state(status, t) {
    const isLost = (i) => kPublisherState[status.publisher_states[i]] === "lost";
    status.publishers.forEach((publisher, i) => (isLost(i) ? this.lose(publisher) : this.lost.delete(publisher)));
    if (t - (this.statusAt ?? -Infinity) < 0.5) return;
    this.statusAt = t;
    const names = zeroTerminated(status.publisher_names);
    const publishers = names.map((name, i) => ({ name, messages: status.applied_sequences[i], silent: status.silent_ns[i] / 1e9, lost: isLost(i) }));
    this.entries.push({ t, kind: "status", value: {
      type: "status", state: kServerState[status.state] ?? "?", version_text: status.server_version, pid: status.pid, epoch: status.epoch, scenes: status.scenes.split("\n").filter(Boolean),
      objects: status.object_count, moving: status.moving_count, contacts: status.contact_count, contacts_truncated: Boolean(status.contacts_truncated), publishers,
    } });
  }

  stand(rows, t) { this.entries.push({ t, kind: "standing", value: rows }); }

  // ---- what the page hears of it

  flush(t) {
    // Definitions come one by one; a table for each would be far too many.
    const tableEvery_s = 0.1;
    if (this.isTableNew && (t - this.tableAt >= tableEvery_s || t >= this.end)) this.tellTable(t);
    if (!this.arePosesNew || !this.table) return;
    this.arePosesNew = false;
    this.frameAt = t;
    const movers = [...this.objects.values()].filter(({ moving }) => moving);
    const origin = (movers[0]?.pose.slice(0, 3) ?? [0, 0, 0]).map(Math.round);
    const numbers = new Float32Array(7 * movers.length);
    movers.forEach((object, i) => {
      const pose = this.poseOf(object);
      numbers.set([pose[0] - origin[0], pose[1] - origin[1], pose[2] - origin[2], ...pose.slice(3)], 7 * i);
    });
    const version = this.entries.length;
    this.entries.push({ t, kind: "poses", value: {
      count: movers.length, worldTime: this.worldTime ?? this.begin + t, tableVersion: version, version, origin, numbers, slots: Uint32Array.from(movers, ({ slot }) => slot), stale: Uint8Array.from(movers, ({ stale }) => Number(stale)),
    } });
  }
  tellTable(t) {
    this.isTableNew = false;
    this.tableAt = t;
    const recorded = [...this.objects.values()].map((object) => ({ ...object, pose: [...this.poseOf(object)] }));
    const names = new Set(recorded.map(({ name }) => name));
    const around = this.surroundings.objects.filter(({ name }) => !names.has(name) && !this.gone.has(name)).map((object) => ({ ...object, slot: this.slotOf(object.name) }));
    const version = this.entries.length;
    this.table = { epoch: 0, version, table_version: version, objects: [...around, ...recorded] };
    this.entries.push({ t, kind: "table", value: { table: this.table, surfaceOf: (number) => this.surfaces.get(number) ?? this.surroundings.surfaceOf(number) } });
    this.arePosesNew = true;
  }
}

function namesOf({ named_ids, names }) {
  const texts = zeroTerminated(names);
  return new Map(named_ids.map((id, i) => [id, texts[i]]));
}
