// Firefox, driven by WebDriver BiDi (W3C, "WebDriver BiDi"). Where it, the module ws or a virtual display is not installed a test is
// skipped.
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { skip, until, words } from "./waiting.mjs";

const firefoxPath = process.env.FIREFOX || "/usr/bin/firefox-esr";
const displayPath = "/usr/bin/Xvfb";
const install = "deploy/install --nightly BUILD";
for (const path of [firefoxPath, displayPath]) if (!existsSync(path)) skip(`no ${path}; ${install}`);
let WebSocket;
try {
  WebSocket = createRequire(join(words.modules, "x.js"))("ws");
} catch {
  skip(`no ws in ${words.modules}; ${install}`);
}

const running = new Set();
function run(program, args, environment, stdio) {
  const child = spawn(program, args, { env: { ...process.env, ...environment }, stdio });
  child.said = "";
  for (const stream of child.stdio.slice(1)) stream?.on("data", (text) => { child.said += text; });
  child.ended = new Promise((done) => child.on("exit", done));
  running.add(child);
  child.ended.then(() => running.delete(child));
  return child;
}
const profiles = [];
process.on("exit", () => {
  for (const child of running) child.kill("SIGKILL");
  for (const folder of profiles) rmSync(folder, { recursive: true, force: true, maxRetries: 10 });
});

/// A display that nobody sees, with graphics by software: {name, stop()}.
export async function startDisplay() {
  // It chooses a free number itself and writes it to the fourth stream.
  const display = run(displayPath, ["-displayfd", "3", "-screen", "0", "1400x1000x24", "-nolisten", "tcp"], {}, ["ignore", "ignore", "pipe", "pipe"]);
  let number = "";
  display.stdio[3].on("data", (text) => { number += text; });
  await until("a display is there", () => number.includes("\n"));
  return { name: `:${number.trim()}`, stop: () => display.kill("SIGTERM") };
}

/// A Firefox with one page.
export class Firefox {
  /// display: of startDisplay(); null: without one, where Firefox has no WebGL
  static async start(display) {
    const firefox = new Firefox();
    const profile = mkdtempSync(join(tmpdir(), "collided_firefox_"));
    profiles.push(profile);
    // A home of its own: it reads nothing of the user's, and leaves nothing behind.
    const environment = { HOME: profile, LIBGL_ALWAYS_SOFTWARE: "1", ...(display ? { DISPLAY: display.name } : {}) };
    const args = [...(display ? [] : ["--headless"]), "--no-remote", "--profile", profile, "--remote-debugging-port", "0", "about:blank"];
    firefox.child = run(firefoxPath, args, environment, ["ignore", "ignore", "pipe"]);
    const address = await until("Firefox listens", () => firefox.child.said.match(/listening on (ws:\S+)/)?.[1], 60);
    await firefox.connect(`${address}/session`);
    return firefox;
  }

  constructor() {
    this.errors = [];  // of the page: what it throws, and what is written to its console as an error
    this.number = 0;
    this.waiting = new Map();
  }

  async connect(address) {
    this.socket = new WebSocket(address);
    this.socket.on("message", (text) => this.hear(JSON.parse(text)));
    await new Promise((done, failed) => this.socket.on("open", done).on("error", failed));
    await this.send("session.new", { capabilities: {} });
    await this.send("session.subscribe", { events: ["log.entryAdded"] });
    this.context = (await this.send("browsingContext.getTree")).contexts[0].context;
  }

  hear(message) {
    if (message.method === "log.entryAdded" && message.params.level === "error") this.errors.push(message.params.text);
    const waiting = this.waiting.get(message.id);
    if (!waiting) return;
    this.waiting.delete(message.id);
    if (message.type === "error") waiting.failed(new Error(`${waiting.method}: ${message.message}`));
    else waiting.done(message.result);
  }
  send(method, params = {}) {
    const id = ++this.number;
    return new Promise((done, failed) => {
      this.waiting.set(id, { done, failed, method });
      this.socket.send(JSON.stringify({ id, method, params }));
    });
  }

  resize(width, height) { return this.send("browsingContext.setViewport", { context: this.context, viewport: { width, height } }); }
  open(url) { return this.send("browsingContext.navigate", { context: this.context, url, wait: "complete" }); }

  /// Calls a function in the page; its value, as JSON has it.
  async evaluate(called, ...args) {
    const expression = `Promise.resolve((${called})(...${JSON.stringify(args)})).then((value) => JSON.stringify(value ?? null))`;
    const { type, result, exceptionDetails } = await this.send("script.evaluate", { target: { context: this.context }, awaitPromise: true, expression });
    if (type === "exception") throw new Error(exceptionDetails.text);
    return JSON.parse(result.value);
  }

  /// Clicks at a place of the page, in pixels.
  click(x, y) {
    const at = { x: Math.round(x), y: Math.round(y) };
    const actions = [{ type: "pointerMove", ...at }, { type: "pointerDown", button: 0 }, { type: "pointerUp", button: 0 }];
    return this.send("input.performActions", { context: this.context, actions: [{ type: "pointer", id: "mouse", parameters: { pointerType: "mouse" }, actions }] });
  }

  async picture(name) {
    if (!words.pictures) return;
    mkdirSync(words.pictures, { recursive: true });
    const { data } = await this.send("browsingContext.captureScreenshot", { context: this.context });
    writeFileSync(join(words.pictures, `${name}.png`), Buffer.from(data, "base64"));
  }

  async stop() {
    await this.send("browser.close").catch(() => this.child.kill("SIGTERM"));
    await this.child.ended;
  }
}
