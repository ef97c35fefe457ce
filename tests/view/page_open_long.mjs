// The page open for long on a world that moves: neither it, its viewer nor the server grows.
//   node page_open_long.mjs --collided PATH --collide PATH --modules DIR [--seconds 3600] [--movers 200] [--rate 20] [--pictures-a-second 2]
// Samples what the page's scripts hold, after a collection, and the memory of the processes. After the warm-up, in which all
// of them fill what they remember, the least of the last third of the samples may be above that of the first by what
// kMostGrowth says: what is made and collected goes up and down, a leak raises the least.
import { readdirSync, readFileSync } from "node:fs";
import { check, launch, until, words } from "./chromium.mjs";
import { environment, runAndStop, start, startServer, startViewer } from "./processes.mjs";

const seconds = Number(words.seconds ?? 3600);
const movers = Number(words.movers ?? 200);
const rate = Number(words.rate ?? 20);
const picturesASecond = Number(words["pictures-a-second"] ?? 2);
const kRemembered_s = 30;
/// The page fills what it remembers, and the server and the viewer theirs: of an hour that takes the first minutes.
const warmUp_s = Math.max(2 * kRemembered_s, seconds / 12);
/// MB. What an allocator or the browser has from the system moves by some; 1 kB lost with each batch of poses of an hour would be
/// 70 MB in each of them.
const kMostGrowth = { heap: 2, renderer: 30, viewer: 8, server: 8 };
const kMostNodes = 200;  // of the page

/// Processes that this one has started, and theirs: {pid, command}.
function descendants() {
  const all = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap((pid) => {
    try {
      const stat = readFileSync(`/proc/${pid}/stat`, "utf8");
      return [{ pid, parent: stat.slice(stat.lastIndexOf(")") + 2).split(" ")[1], command: readFileSync(`/proc/${pid}/cmdline`, "utf8") }];
    } catch {
      return [];  // it has ended meanwhile
    }
  });
  const mine = new Set([String(process.pid)]);
  for (let size = 0; size !== mine.size;) {
    size = mine.size;
    for (const { pid, parent } of all) if (mine.has(parent)) mine.add(pid);
  }
  return all.filter(({ pid }) => mine.has(pid));
}
/// Memory that a process has and shares with no file, MB.
function resident(pid) {
  const text = readFileSync(`/proc/${pid}/status`, "utf8");
  return ["RssAnon", "RssShmem"].reduce((sum, name) => sum + Number(text.match(new RegExp(`${name}:\\s+(\\d+)`))[1]), 0) / 1024;
}
const rendererPid = () => descendants().filter(({ command }) => command.includes("--type=renderer")).sort((a, b) => resident(b.pid) - resident(a.pid))[0].pid;

/// Throws where the page does not answer; a busy machine may keep it waiting for long.
function inTime(answer) {
  const patience_ms = 300e3;
  return Promise.race([answer, new Promise((_, failed) => setTimeout(() => failed(new Error(`the page does not answer for ${patience_ms / 1000} s`)), patience_ms).unref())]);
}

async function sample(session, pids) {
  let usedSize = Infinity;
  let nodes = Infinity;
  // On a busy machine the page makes and drops some between a collection and the count.
  for (let i = 0; i < 3; ++i) {
    await session.send("HeapProfiler.collectGarbage");
    usedSize = Math.min(usedSize, (await session.send("Runtime.getHeapUsage")).usedSize);
    nodes = Math.min(nodes, (await session.send("Memory.getDOMCounters")).nodes);
  }
  return { heap: usedSize / 1e6, nodes, ...Object.fromEntries(Object.entries(pids).map(([name, pid]) => [name, resident(pid)])) };
}

function judge(samples) {
  const third = Math.floor(samples.length / 3);
  check(third >= 3, `only ${samples.length} samples`);
  const wrong = [];
  for (const [name, most] of [...Object.entries(kMostGrowth), ["nodes", kMostNodes]]) {
    const [first, last] = [samples.slice(0, third), samples.slice(-third)].map((part) => Math.min(...part.map((one) => one[name])));
    const highest = Math.max(...samples.map((one) => one[name]));
    const unit = name === "nodes" ? "" : " MB";
    console.log(`${name}: ${first.toFixed(1)} to ${last.toFixed(1)}${unit}, at most ${highest.toFixed(1)}${unit}; allowed growth ${most}${unit}`);
    if (!(last - first <= most)) wrong.push(`${name} has grown by ${(last - first).toFixed(1)}${unit}`);
  }
  check(wrong.length === 0, wrong.join("; "));
}

async function openPage(browser, url) {
  const page = await browser.newPage({ viewport: { width: 900, height: 640 } });
  // Fewer pictures, so that an hour of them costs little where there is no graphics card.
  await page.addInitScript((pause_ms) => {
    window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), pause_ms);
  }, 1000 / picturesASecond);
  page.wrong = [];
  page.on("pageerror", (error) => page.wrong.push(error.message));
  await page.goto(url, { waitUntil: "commit" });
  await until("all objects are there", () => page.evaluate((count) => window.collidedPage?.world.movers?.length >= count, movers), 60);
  return page;
}

async function run() {
  const server = await startServer();
  start(words.collide, ["publish", "--spheres", String(movers), "--side", "14", "--size", "0.2", "--speed", "1", "--round", "--bounce", "--rate", String(rate), "--as", "crowd", "--name", "ball"]);
  const { viewer, url } = await startViewer();
  const browser = await launch();
  const page = await openPage(browser, url);
  const session = await page.context().newCDPSession(page);
  const pids = { renderer: rendererPid(), viewer: viewer.pid, server: server.pid };
  console.log(`domain ${environment.COLLIDED_DOMAIN}: ${movers} movers at ${rate} Hz, ${picturesASecond} pictures a second, for ${seconds} s after ${warmUp_s} s`);
  await new Promise((done) => setTimeout(done, 1000 * warmUp_s));
  const every_s = Math.min(60, seconds / 12);
  const samples = [];
  const begun = Date.now();
  const messages = () => page.evaluate(() => collidedPage.contacts.changes);
  const eventsBefore = await messages();
  while (Date.now() - begun < 1000 * seconds) {
    samples.push(await inTime(sample(session, pids)));
    console.log(`${((Date.now() - begun) / 1000).toFixed(0)} s: ${Object.entries(samples.at(-1)).map(([name, value]) => `${name} ${value.toFixed(name === "nodes" ? 0 : 1)}`).join(", ")}`);
    await new Promise((done) => setTimeout(done, 1000 * every_s));
  }
  const heard = (await messages()) - eventsBefore;
  console.log(`${heard} events were heard`);
  check(heard > 0, "nothing has happened in this world");
  check(page.wrong.length === 0, `the page's errors: ${page.wrong.join("; ")}`);
  judge(samples);
  await browser.close();
}

await runAndStop("open for long", run);
