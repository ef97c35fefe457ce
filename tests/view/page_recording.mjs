// Tests of the page: recordings, and files that are none. browser.mjs opens real ones.
import { readFileSync } from "node:fs";
import { deflateSync } from "node:zlib";
import { check, picture, until, words as options } from "./chromium.mjs";
import { files, hall, open, shut, textOf } from "./page_fixture.mjs";

const text = (words) => {
  const bytes = Buffer.from(words);
  const size = Buffer.alloc(4);
  size.writeUInt32LE(bytes.length);
  return Buffer.concat([size, bytes]);
};
const record = (opcode, ...parts) => {
  const content = Buffer.concat(parts);
  const head = Buffer.alloc(9);
  head.writeUInt8(opcode);
  head.writeBigUInt64LE(BigInt(content.length), 1);
  return Buffer.concat([head, content]);
};
const number = (value, bytes) => {
  const out = Buffer.alloc(bytes);
  out.writeUIntLE(value, 0, Math.min(6, bytes));
  return out;
};
/// A FlatBuffers table whose members come one after the other: numbers as bytes, or {table}, {list (bytes), count} and {tables}, which
/// follow it. Every member has room for three doubles, and its alignment.
function flatTable(members) {
  const count = 1 + Math.max(...Object.keys(members).map(Number));
  const head = Buffer.alloc(8 * Math.ceil((4 + 2 * count) / 8));
  head.writeUInt16LE(4 + 2 * count, 0);
  const fields = Buffer.alloc(8 + 24 * count);
  fields.writeInt32LE(head.length, 0);
  const after = [];
  let at = head.length + fields.length;
  const append = (bytes) => {
    const start = at;
    const padded = Buffer.concat([bytes, Buffer.alloc((8 - (bytes.length % 8)) % 8)]);
    after.push(padded);
    at += padded.length;
    return start;
  };
  const listOf = (size, content) => {
    // Its elements are aligned, its count stands before them.
    const start = append(Buffer.concat([number(0, 4), number(size, 4), content]));
    return start + 4;
  };
  for (const [member, value] of Object.entries(members)) {
    const place = 8 + 24 * member;
    head.writeUInt16LE(place, 4 + 2 * member);
    const here = head.length + place;
    if (Buffer.isBuffer(value)) value.copy(fields, place);
    else if (value.list) fields.writeUInt32LE(listOf(value.count, value.list) - here, place);
    else if (value.table) fields.writeUInt32LE(append(value.table.bytes) + value.table.start - here, place);
    else {
      const list = listOf(value.tables.length, Buffer.alloc(4 * value.tables.length));
      const offsets = after.at(-1);
      fields.writeUInt32LE(list - here, place);
      value.tables.forEach((table, i) => offsets.writeUInt32LE(append(table.bytes) + table.start - (list + 4 + 4 * i), 8 + 4 * i));
    }
  }
  return { bytes: Buffer.concat([head, fields, ...after]), start: head.length };
}
const rooted = ({ bytes, start }) => Buffer.concat([number(8 + start, 4), number(0, 4), bytes]);
const doubles = (...values) => Buffer.from(new Float64Array(values).buffer);
const wholes = (...values) => Buffer.from(new Uint32Array(values).buffer);
const listOfDoubles = (values) => ({ list: doubles(...values), count: values.length });

/// A page with a run in it, as `collide view --save` writes it, plays without a click, once, to its end.
export async function savedRunsPlayByThemselves() {
  const world = hall();
  const packed = (bytes) => deflateSync(bytes).toString("base64");
  const messages = [{ t: 0, kind: "text", data: JSON.stringify({ type: "hello", version: "x", up: "z", connection: "" }) }, { t: 0, kind: "objects", data: packed(JSON.stringify(world.table())) }];
  for (let i = 0; i <= 40; ++i) {
    world.objects[world.slotOf("ball_1")].pose[0] = i / 20;
    messages.push({ t: i / 20, kind: "poses", data: packed(world.poses(i / 20)) });
  }
  const run = JSON.stringify({ begin: 0, end: 2, messages, surfaces: {} });
  files["/saved"] = ["text/html", files["/"][1].replace(`<script src="view.js">`, `<script type="application/json" id="run">${run}</script>\n<script src="view.js">`)];
  const page = await open(world, { path: "saved" });
  const at = () => page.evaluate(() => collidedPage.timeline.at);
  await until("it comes to its end", async () => (await at()) === 2);
  check(await page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0] === 2 && !collidedPage.timeline.isPlaying), "its end is not shown, or it goes on");
  await page.click("#play");
  await until("it plays again", async () => (await at()) > 0 && (await at()) < 1.5);
  await shut(page);
}

const kMagic = Buffer.from([0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a]);
const described = (type, topic, id = 1) => [record(3, number(id, 2), text(`collided::wire_v2::${type}`), text("omgidl"), text("")), record(4, number(id, 2), number(id, 2), text(topic), text("cdr"), number(0, 4))];
const message = (bytes, id = 1, time_ns = 1000) => record(5, number(id, 2), number(1, 4), number(time_ns, 8), number(time_ns, 8), bytes);

/// Drops bytes on the page as a file.
const drop = (page, name, bytes) => page.evaluate(([called, numbers]) => {
  const data = new DataTransfer();
  data.items.add(new File([new Uint8Array(numbers)], called));
  window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
}, [name, [...bytes]]);

/// A definition as it is recorded; numbers before the shape are as in idl/collided.idl.
function definition(objectNumber, name, shape) {
  const parts = [];
  let at = 0;
  const put = (bytes, alignment = 1) => {
    const gap = (alignment - (at % alignment)) % alignment;
    parts.push(Buffer.alloc(gap), bytes);
    at += gap + bytes.length;
  };
  const putText = (words) => {
    put(wholes(words.length + 1), 4);
    put(Buffer.from(`${words}\0`));
  };
  put(number(7, 8), 8);
  put(wholes(objectNumber), 4);
  put(number(1, 8), 8);
  put(number(objectNumber, 8), 8);
  put(Buffer.from([0, 1, 0]));
  putText("robot");
  putText(name);
  for (const filter of [1, 0xffffffff, 0]) put(wholes(filter), 4);
  put(doubles(0, 0, 0, 1, 0, 0, 0), 8);
  put(wholes(shape.length), 4);
  put(shape);
  return Buffer.concat([Buffer.from([0, 1, 0, 0]), ...parts]);
}

/// Samples as they are recorded, by the generated table of their members (browser.mjs compares that with real ones): `members`
/// has those that are not 0 or empty.
const kSamples = Function(`return (() => { ${readFileSync(options.contract, "utf8").match(/const kSamples = \{[\s\S]*?\n\};/)[0]} return kSamples; })()`)();
function sample(type, members) {
  const parts = [];
  let at = 0;
  const put = (bytes, alignment) => {
    const gap = (alignment - (at % alignment)) % alignment;
    parts.push(Buffer.alloc(gap), bytes);
    at += gap + bytes.length;
  };
  const widths = { u8: 1, u32: 4, u64: 8, i64: 8, f64: 8 };
  const putNumber = (kind, value) => {
    const bytes = Buffer.alloc(widths[kind]);
    if (kind === "f64") bytes.writeDoubleLE(value);
    else if (kind === "u8" || kind === "u32") bytes.writeUIntLE(value, 0, bytes.length);
    else bytes.writeBigInt64LE(BigInt(value));
    put(bytes, bytes.length);
  };
  for (const [name, kind] of kSamples[type].split(",").map((member) => member.trim().split(/\s+/))) {
    const value = members[name];
    if (kind === "text") {
      putNumber("u32", Buffer.byteLength(value ?? "") + 1);
      put(Buffer.from(`${value ?? ""}\0`), 1);
    } else if (kind.endsWith("*")) {
      putNumber("u32", value?.length ?? 0);
      for (const one of value ?? []) putNumber(kind.slice(0, -1), one);
    } else if (kind.endsWith("]")) for (const one of value) putNumber("f64", one);
    else putNumber(kind, value ?? 0);
  }
  return Buffer.concat([Buffer.from([0, 1, 0, 0]), ...parts]);
}
const namesIn = (names) => ({ named_ids: names.map((_, i) => i + 1), names: Buffer.from(names.map((name) => `${name}\0`).join("")) });

const kBegin_ns = 1e9;

/// Commands and their answers: what a command did is what its answer says.
class RecordedCommands {
  constructor() {
    this.time_ns = kBegin_ns;
    this.bytes = [kMagic];
    ["Query", "Reply", "Definition", "PoseBatch", "EventFrame", "ContactShard"].forEach((type, i) => this.bytes.push(...described(type, `collided/${type}`, i + 1)));
    this.requests = 0;
  }
  add(type, members) {
    const id = ["Query", "Reply", "Definition", "PoseBatch", "EventFrame", "ContactShard"].indexOf(type) + 1;
    this.bytes.push(message(sample(type, members), id, this.time_ns));
    this.time_ns += 2e8;
    return this;
  }
  opening(count) {
    const entry = Buffer.concat([text("opening_messages"), text(String(count))]);
    this.bytes.push(record(12, text("recording"), number(entry.length, 4), entry));
    return this;
  }
  /// answer: null: none; a text: a refusal
  command(members, answer = {}, blob = Buffer.alloc(0)) {
    const request = ++this.requests;
    this.add("Query", { client: 7, request, chunk_count: 1, kind: 5, text: JSON.stringify(members), blob });
    if (answer === null) return this;
    const isRefused = typeof answer === "string";
    return this.add("Reply", { client: 7, request, chunk_count: 1, status: isRefused ? 1 : 0, text: Buffer.from(JSON.stringify(isRefused ? { message: answer } : answer)) });
  }
  /// Seconds from the beginning.
  now() { return (this.time_ns - kBegin_ns) / 1e9; }
  file() { return Buffer.concat(this.bytes); }
}
const ballShape = () => rooted(flatTable({ 0: { list: doubles(0, 0, 0, 0.25), count: 1 } }));
const shownNames = (page) => page.evaluate(() => [...collidedPage.world.byName.keys()].sort().join());
const goTo = async (page, seconds) => {
  await page.evaluate((t) => {
    collidedPage.timeline.pause();
    collidedPage.timeline.goTo(t);
  }, seconds);
  await until("its poses are applied", () => page.evaluate(() => !collidedPage.pendingPoses));
};
const dropAndShow = async (page, name, run) => {
  await drop(page, name, run.file());
  await until(`${name} is shown`, async () => (await textOf(page, "#recording")).includes(name));
};

/// A removal by a glob takes what its answer names, a refused command and one without an answer do nothing, what is attached goes
/// along, and a scale counts.
export async function commandsOfRecordingsDoWhatTheirAnswersSay() {
  const page = await open(hall());
  const at = (x) => [x, 0, 0, 1, 0, 0, 0];
  const added = (name, more = {}) => [{ command: "add", name, pose: at(1), ...more }, { name }, ballShape()];
  const run = new RecordedCommands().opening(3);
  // Of the opening, without answers: two additions, and a removal of what the scene has.
  run.command({ command: "add", name: "crate_0", pose: at(0) }, null, ballShape()).command({ command: "add", name: "lamp", pose: at(0) }, null, ballShape()).command({ command: "remove", name: "shelf_[1]" }, null);
  run.command(...added("crate_1")).command(...added("crate_2", { scale: [2, 2, 2] })).command(...added("Crate_3"));
  run.command({ command: "move", name: "crate_1", pose: at(9) }, "object 'crate_1' is attached to 'lamp', which moves it");
  run.command({ command: "add", name: "unanswered", pose: at(0) }, null, ballShape());
  run.command({ command: "add", name: "refused", pose: at(0) }, "add: the shape is empty", ballShape());
  run.command({ command: "attach", child: "crate_2", parent: "crate_1" }, { child: "crate_2", parent: "crate_1", pose: [0, 1, 0, 1, 0, 0, 0] });
  run.command({ command: "move", name: "crate_1", pose: [5, 0, 0, Math.SQRT1_2, 0, 0, Math.SQRT1_2] }, { name: "crate_1" });
  const beforeRemoval = run.now();
  run.command({ command: "remove", name: "crate_*" }, { removed: ["crate_0", "crate_1"], detached: ["crate_2"] });
  run.command({ command: "move", name: "lamp", pose: at(3) }, { name: "lamp" });
  await dropAndShow(page, "commands.mcap", run);
  await goTo(page, beforeRemoval);
  const names = await shownNames(page);
  check(names === "Crate_3,crate_0,crate_1,crate_2,floor,lamp,shelf_2,site", `before the removal it has ${names}`);
  const before = await page.evaluate(() => ["crate_1", "crate_2"].map((name) => collidedPage.world.byName.get(name).position.map((part) => Number(part.toFixed(5))).join(" ")));
  check(before.join() === "5 0 0,4 0 0", `what is attached, and what it is attached to, are at ${before}`);
  check(await page.evaluate(() => collidedPage.world.byName.get("crate_2").parts[0][4] === 0.5), "a scaled ball is as large as without its scale");
  await goTo(page, 1e9);
  const after = await shownNames(page);
  check(after === "Crate_3,crate_2,floor,lamp,shelf_2,site", `after the removal it has ${after}`);
  check(await page.evaluate(() => Math.abs(collidedPage.world.byName.get("crate_2").position[0] - 4) < 1e-5), "what was attached does not stay where it was");
  await shut(page);
}

/// What lies within a solid is told so, at the beginning and by events, and no more once it has emerged.
export async function recordingsTellWhatIsWithin() {
  const page = await open(hall());
  const within = 0xfffffffe;
  const pairs = { points: [0, 0, 0, 0, 0, 0], normals: [0, 0, 1, 0, 0, 1], depths: [0.1, 0.1], depth_errors: [0, 0], doubts: [0, 0], a: [1, 1], b: [2, 3], episodes: [1, 2] };
  const one = { points: [0, 0, 0], normals: [0, 0, 1], depths: [0.1], depth_errors: [0], doubts: [0], a: [1], bracket_highs: [0], reasons: [0], velocities: [0, 0, 0], ...namesIn(["pea", "pod", "bowl"]) };
  const run = new RecordedCommands().opening(4);
  for (const name of ["pea", "pod", "bowl"]) run.command({ command: "add", name }, null, ballShape());
  run.add("ContactShard", { ...pairs, began_ns: [1, 1], a_triangles: [within, 0xffffffff], b_triangles: [0xffffffff, within], ...namesIn(["pea", "pod", "bowl"]) });
  run.add("EventFrame", { ...one, first_sequence: 9, kinds: [4], b: [2], episodes: [1], a_triangles: [within], b_triangles: [0xffffffff] });
  run.add("EventFrame", { ...one, first_sequence: 10, kinds: [3], b: [2], episodes: [1], a_triangles: [within], b_triangles: [0xffffffff] });
  await dropAndShow(page, "within.mcap", run);
  const told = async (part) => {
    await goTo(page, part);
    return page.evaluate(() => ["pod", "bowl"].map((other) => collidedPage.contacts.of("pea").find(({ b }) => b === other)?.contained ?? "-").join());
  };
  for (const [part, expected] of [[0, "a,b"], [0.85, "-,b"], [1, "a,b"]]) {
    const found = await told(part);
    check(found === expected, `at ${part} of it the pea lies ${found} (a: within the pod, b: the bowl within it), not ${expected}`);
  }
  await shut(page);
}

/// Hulls, height fields, voxels and vertex buffers of recordings are drawn as what the server makes of them.
export async function everyKindOfShapeIsDrawn() {
  const page = await open(hall());
  const cube = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((bits) => [bits & 1, (bits >> 1) & 1, bits >> 2]);
  const inside = Array.from({ length: 30 }, (_, i) => [0.1 + 0.027 * i, 0.5, 0.9 - 0.025 * i]).flat();
  const buffer = (kind, values, more = {}) => flatTable({ 0: Buffer.from([kind]), 1: Buffer.from([1]), 2: wholes(32), 3: wholes(8), 4: { list: Buffer.concat(values.map((point) => doubles(0, ...point))), count: 32 * values.length }, 7: doubles(0.1), ...more });
  const square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]];
  const noCorners = { list: Buffer.alloc(0), count: 0 };
  const shapes = {
    hull: flatTable({ 8: { tables: [flatTable({ 0: listOfDoubles([...inside, ...cube]), 1: noCorners })] }, 13: doubles(2, 2, 2) }),
    heights: flatTable({ 10: { table: flatTable({ 0: wholes(3), 1: doubles(0.5), 2: doubles(1), 3: listOfDoubles([0, 0, 0, 0, 0, 0]) }) } }),
    // An L of five cells along x and y, and one above its corner.
    voxels: flatTable({ 17: { tables: [flatTable({ 0: doubles(0.5), 1: wholes(2 ** 32 - 1), 2: wholes(0), 3: wholes(4), 4: wholes(3), 5: wholes(3), 6: wholes(2), 7: { list: Buffer.from([0b01001111, 0b00000010, 0]), count: 3 } })] } }),
    points: flatTable({ 14: { tables: [buffer(0, square)] } }),
    segments: flatTable({ 14: { tables: [buffer(1, square)] } }),
    polyline: flatTable({ 14: { tables: [buffer(2, square, { 5: wholes(2), 6: { list: Buffer.from([0, 0, 1, 0, 3, 0]), count: 6 } })] } }),
    triangles: flatTable({ 14: { tables: [buffer(3, square, { 5: wholes(4), 6: { list: wholes(0, 1, 3, 0, 3, 2), count: 24 } })] } }),
    fan: flatTable({ 14: { tables: [buffer(4, [square[0], square[1], square[3], square[2]])] } }),
    strip: flatTable({ 14: { tables: [buffer(5, square)] } }),
  };
  const bytes = Buffer.concat([kMagic, ...described("Definition", "collided/object_v2"), ...Object.entries(shapes).map(([name, shape], i) => message(definition(i, name, rooted(shape))))]);
  await drop(page, "shapes.mcap", bytes);
  await until("they are there", () => page.evaluate((names) => names.every((name) => collidedPage.world.byName.has(name)), Object.keys(shapes)));
  const found = await page.evaluate((names) => Object.fromEntries(names.map((name) => {
    const { parts, runs } = collidedPage.world.byName.get(name);
    let [area, volume] = [0, 0];
    for (const [number] of runs) {
      const { positions, corners, origin } = collidedPage.timeline.shownTable.surfaceOf(number);
      const at = (i) => [0, 1, 2].map((axis) => origin[axis] + positions[3 * corners[i] + axis]);
      const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      for (let i = 0; i < corners.length; i += 3) {
        const [a, b, c] = [at(i), at(i + 1), at(i + 2)];
        const normal = cross(b.map((part, axis) => part - a[axis]), c.map((part, axis) => part - a[axis]));
        area += Math.hypot(...normal) / 2;
        volume += a.reduce((sum, part, axis) => sum + part * normal[axis], 0) / 6;
      }
    }
    return [name, { parts: parts.map((part) => part.map((n) => Number(n.toFixed(6)))), area: Number(area.toFixed(6)), volume: Number(volume.toFixed(6)) }];
  })), Object.keys(shapes));
  const expect = (name, expected) => check(JSON.stringify(found[name]) === JSON.stringify(expected), `${name} is ${JSON.stringify(found[name])}, not ${JSON.stringify(expected)}`);
  const flat = { parts: [], area: 1, volume: 0 };
  expect("hull", { parts: [], area: 24, volume: 8 });
  for (const name of ["heights", "triangles", "fan", "strip"]) expect(name, flat);
  const box = (center, half) => [1, ...center, 1, 0, 0, 0, ...half];
  expect("voxels", { parts: [box([0.25, 0.25, 2.25], [0.75, 0.25, 0.25]), box([-0.25, 1, 2.25], [0.25, 0.5, 0.25]), box([-0.25, 0.25, 2.75], [0.25, 0.25, 0.25])], area: 0, volume: 0 });
  const ball = (point) => [0, ...point, 0.1];
  const rod = (a, b) => [2, ...a, ...b, 0.1];
  expect("points", { ...flat, area: 0, parts: square.map(ball) });
  expect("segments", { ...flat, area: 0, parts: [rod(square[0], square[1]), rod(square[2], square[3])] });
  expect("polyline", { ...flat, area: 0, parts: [rod(square[0], square[1]), rod(square[1], square[3])] });
  await picture(page, "recorded_shapes");
  await shut(page);
}

/// What is wrong with a file is said, and the page goes on as before.
export async function filesThatAreNoRecordingsAreRefused() {
  const world = hall();
  const page = await open(world);
  const cases = [
    ["notes.txt", Buffer.from("# notes\n"), /notes\.txt: this is no MCAP file/],
    ["nothing.mcap", kMagic, /nothing\.mcap: the recording has no messages/],
    ["noise.mcap", Buffer.concat([kMagic, ...described("Definition", "collided/object_v2"), message(Buffer.from("0001000012345678", "hex"))]), /nothing in it has a place/],
    ["huge.mcap", Buffer.concat([kMagic, ...described("PoseBatch", "collided/pose_v2"), message(Buffer.concat([Buffer.from([0, 1, 0, 0]), Buffer.alloc(48, 255)])), Buffer.from([5, 255, 255, 255, 255, 255, 255, 255, 127])]), /nothing in it has a place/],
    ["<img src=x onerror=\"window.isBroken=1\">", Buffer.from("x"), /<img src=x/],
  ];
  for (const [name, bytes, expected] of cases) {
    await drop(page, name, bytes);
    await until(`${name} is refused`, async () => expected.test(await textOf(page, "#answer-text")));
  }
  check(await page.evaluate(() => !window.isBroken && document.getElementById("recording").hidden), "one of them was opened, or read as HTML");
  world.objects[world.slotOf("ball_1")].pose[0] = 2;
  world.move(5);
  await until("the page is live", () => page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0] === 2));
  await shut(page);
}
