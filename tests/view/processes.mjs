// A server of its own, its publishers and viewers, for the tests of the page against real programs.
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, until, words } from "./waiting.mjs";

export const scratch = mkdtempSync(join(tmpdir(), "collided_view_"));
export const environment = { ...process.env, COLLIDED_STATE_DIR: scratch, NO_COLOR: "1" };
const started = [];

export function start(program, args, stdin = "ignore") {
  const child = spawn(program, args, { env: environment, stdio: [stdin, "pipe", "pipe"] });
  child.said = "";
  child.stdout.on("data", (text) => { child.said += text; });
  child.stderr.on("data", (text) => { child.said += text; });
  child.ended = new Promise((done) => child.on("exit", done));
  started.push(child);
  return child;
}

export async function startServer(...args) {
  const server = start(words.collided, args);
  await until("the server is ready", () => server.said.includes("ready:") || server.exitCode !== null);
  check(server.exitCode === null, server.said);
  return server;
}

/// A viewer of the server: {viewer, url}.
export async function startViewer(...args) {
  const viewer = start(words.collide, ["view", "--port", "0", "--plain", ...args]);
  const url = await until("the viewer says where it is", () => viewer.said.match(/http:\/\/\S+/)?.[0]);
  return { viewer, url };
}

/// Runs `collide` to its end.
export const collide = (...args) => spawnSync(words.collide, args, { env: environment, encoding: "utf8", timeout: 20000 });

/// Runs a test, says how it went, and ends all programs that were started, and then this one.
export async function runAndStop(name, run) {
  try {
    await run();
    console.log(`${name}: all as it should be`);
  } catch (failed) {
    console.error(`${name}: ${failed.message}`);
    for (const child of started) console.error(`--- ${child.spawnargs.slice(0, 3).join(" ")}\n${child.said.slice(-600)}`);
    process.exitCode = 1;
  } finally {
    await stopAll();
    process.exit();
  }
}
async function stopAll() {
  for (const child of started.reverse()) {
    child.kill("SIGCONT");
    child.kill("SIGTERM");
    const timer = setTimeout(() => child.kill("SIGKILL"), 8000);
    await child.ended;
    clearTimeout(timer);
  }
  rmSync(scratch, { recursive: true, force: true });
}
