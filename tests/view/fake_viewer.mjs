// A viewer that is none: answers what the page asks for, out of a world made here, so that a test knows every pixel and row.
import { readFileSync } from "node:fs";
import { join } from "node:path";

const kUnturned = [1, 0, 0, 0];
export const kAddress = "http://fake-viewer/";

/// The page's files as the build puts them together (client/view/embed.cmake).
export function pageFiles(source) {
  const parts = readFileSync(join(source, "embed.cmake"), "utf8").match(/foreach\(part ([^)]*)\)/)[1].trim().split(/\s+/);
  const read = (name) => readFileSync(join(source, "page", name), "utf8");
  const script = `(() => {\n"use strict";\n${parts.map((part) => read(`${part}.js`)).join("\n")}})();\n`;
  return { "/": ["text/html", read("index.html")], "/view.css": ["text/css", read("view.css")], "/view.js": ["text/javascript", script] };
}

export class FakeWorld {
  constructor() {
    this.objects = [];
    this.surfaces = new Map();  // by number, as /surface answers
    this.version = 1;
    this.asked = [];
    this.posted = [];      // bytes of the recordings that the page has sent
    this.recording = null; // () => {status, body}, the answer to them; null: the connection breaks off
    this.connections = 0;
  }
  /// part: kind and numbers as in client/view/page_messages.hpp
  add(name, part, { moving = false, scene = "", layers = 1, mask = 0xffffffff, group = 0, at = [0, 0, 0], stale = false } = {}) {
    this.objects.push({ slot: this.objects.length, name, scene, moving, stale, layers, mask, group, pose: [...at, ...kUnturned], parts: [part], runs: [] });
    return this;
  }
  box(name, center, half, options) { return this.add(name, [1, ...center, ...kUnturned, ...half], options); }
  sphere(name, at, radius, options) { return this.add(name, [0, 0, 0, 0, radius], { moving: true, ...options, at }); }
  /// Objects that are boxes of triangles, all in one surface, as the parts of a file: [name, center, half].
  file(scene, boxes) {
    const number = String(1000 + this.surfaces.size);
    const bytes = Buffer.alloc(32 + 12 * 8 * boxes.length + 12 * 12 * boxes.length);
    bytes.writeUInt32LE(8 * boxes.length, 0);
    bytes.writeUInt32LE(12 * boxes.length, 4);
    const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    const corners = sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
    boxes.forEach(([name, center, half], i) => {
      for (let k = 0; k < 8; ++k) center.forEach((middle, axis) => bytes.writeFloatLE(middle + ((k >> axis) & 1 ? 1 : -1) * half[axis], 32 + 12 * (8 * i + k) + 4 * axis));
      corners.forEach((corner, k) => bytes.writeUInt32LE(8 * i + corner, 32 + 12 * 8 * boxes.length + 4 * (36 * i + k)));
      this.add(name, null, { scene });
      Object.assign(this.objects.at(-1), { parts: [], runs: [[number, 12 * i, 12]] });
    });
    this.surfaces.set(number, bytes);
    return this;
  }
  slotOf(name) { return this.objects.findIndex((object) => object.name === name); }

  table() { return { epoch: 7, version: this.version, table_version: 1, objects: this.objects }; }

  poses(time) {
    const movers = this.objects.filter(({ moving }) => moving);
    const bytes = Buffer.alloc(56 + 33 * movers.length);
    bytes.writeUInt32LE(1, 0);
    bytes.writeUInt32LE(movers.length, 4);
    [time, 1, ++this.version, 0, 0, 0].forEach((value, i) => bytes.writeDoubleLE(value, 8 + 8 * i));
    movers.forEach((object, i) => {
      object.pose.forEach((value, k) => bytes.writeFloatLE(value, 56 + 28 * i + 4 * k));
      bytes.writeUInt32LE(object.slot, 56 + 28 * movers.length + 4 * i);
      bytes.writeUInt8(object.stale ? 1 : 0, 56 + 32 * movers.length + i);
    });
    return bytes;
  }

  status(more = {}) {
    return {
      type: "status", state: "ready", version_text: "0.2.0", pid: 4711, namespace: "collided", epoch: 7, world: 18204, world_time: 1, scenes: ["hall"], static_triangles: 0,
      objects: this.objects.length, moving: this.objects.filter(({ moving }) => moving).length, contacts: 0, contacts_truncated: false, questions_answered: 0, undecided_answers: 0, in_doubt: 0, publishers: [], ...more,
    };
  }
  event(what, a, b, more = {}) {
    return { what, a, b, a_slot: this.slotOf(a), b_slot: this.slotOf(b), time: 1.7e9 + this.version, sequence: ++this.version, episode: 1, ...(what === "ended" ? { why: "separated", after: 1 } : { point: [0, 0, 0.5], normal: [0, 0, 1], depth: 0.0123, error: 1e-16 }), ...more };
  }

  /// Serves a page of the browser; afterwards tell(message) and move(time) reach it.
  async serve(page, files, answers = {}) {
    await page.route(`${kAddress}**`, (route) => {
      const { pathname: path, searchParams } = new URL(route.request().url());
      if (path === "/recording") {
        this.posted.push(route.request().postDataBuffer());
        const answer = this.recording?.();
        return answer ? route.fulfill({ contentType: "application/json", ...answer }) : route.abort();
      }
      if (path === "/surface") return route.fulfill({ contentType: "application/octet-stream", body: this.surfaces.get(searchParams.get("number")) });
      if (path === "/objects") return route.fulfill({ contentType: "application/json", body: JSON.stringify(this.table()) });
      const file = files[path];
      return file ? route.fulfill({ contentType: file[0], body: file[1] }) : route.fulfill({ status: 404, body: "" });
    });
    await page.routeWebSocket("ws://fake-viewer/live", (socket) => {
      const isFirst = this.connections++ === 0;
      this.socket = socket;
      this.tell({ type: "hello", version: "x", up: "z", connection: "--domain 7 --namespace hall " });
      this.tell(this.lastStatus ?? this.status());
      this.tell({ type: "table", epoch: 7, table_version: 1 });
      // A page that was not served for 5 s, on a busy machine, connects again, and finds what it had.
      if (isFirst) this.tell({ type: "contacts", contacts: [], left_out: 0 });
      this.move(this.time ?? 0);
      // As a viewer does, it says something twice a second; a page that hears nothing takes it for gone.
      clearInterval(this.alive);
      this.alive = setInterval(() => this.tell({ type: "alive" }), 500).unref();
      socket.onClose(() => clearInterval(this.alive));
      socket.onMessage((text) => {
        const question = JSON.parse(text);
        this.asked.push(question);
        const answer = answers[question.ask]?.(question);
        if (answer) this.tell({ type: "answer", ...question, ...answer });
      });
    });
  }
  tell(message) {
    if (message.type === "status") this.lastStatus = message;
    this.socket.send(JSON.stringify(message));
  }
  move(time) {
    this.time = time;
    this.socket.send(this.poses(time));
  }
}
