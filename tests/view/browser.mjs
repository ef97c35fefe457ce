// The page in a real browser, against a real server with real publishers.
//   node browser.mjs --collided PATH --collide PATH --modules DIR --pictures DIR [--long]
// DIR of --modules holds node_modules/playwright-core (npm install --prefix DIR playwright-core); CHROMIUM names the browser.
// Prints what was measured; exits 0, 1 on the first thing that is wrong, 77 where there is no browser.
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { join } from "node:path";
import { check, launch, picture, until, words } from "./chromium.mjs";
import { collide, environment, runAndStop, scratch, start, startServer, startViewer } from "./processes.mjs";

const isLong = process.argv.includes("--long");

// ---- what the page shows, read from the page itself

const state = (page) => page.evaluate(() => document.getElementById("state")?.textContent ?? "");
const isReady = async (page) => (await state(page)).startsWith("ready");
const positions = (page) => page.evaluate(() => [...collidedPage.world.objects.values()].filter((o) => o.moving).map((o) => o.position.join()).sort());

async function moves(page) {
  const before = (await positions(page)).join(" ");
  await until("objects move", async () => {
    const now = await positions(page);
    return now.length > 0 && now.join(" ") !== before;
  });
}

/// Whether anything but paper is in the picture's middle: parts of its pixels that are ink, tone or accent.
async function inked(page) {
  return page.evaluate(async () => {
    collidedPage.changed();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    let seen = 0;
    for (let x = 0.05; x < 0.95; x += 0.05) for (let y = 0.05; y < 0.95; y += 0.05) seen += collidedPage.picture.renderer.pick(x, y) ? 1 : 0;
    return seen / (18 * 18);
  });
}

async function seesTheWorld(page) {
  await until("the page is ready", () => isReady(page), 60);
  await until("the scene's objects are there", () => page.evaluate(() => collidedPage.world.objects.size > 30));
  await moves(page);
  const part = await inked(page);
  check(part > 0.1, `the picture is nearly empty: ${part}`);
  console.log(`loads: ${await page.evaluate(() => collidedPage.world.objects.size)} objects, they move; ${Math.round(100 * part)} % of the picture is inked`);
}

/// From the event's time by the server's clock to the picture that shows it, by this machine's.
async function flashesInTime(page) {
  await until("contacts flash", () => page.evaluate(() => collidedPage.flashes.filter(({ shown }) => shown).length >= 10), 30);
  await page.evaluate(() => { collidedPage.flashes = []; });
  const wanted = isLong ? 100 : 15;
  await until("contacts flash", () => page.evaluate((count) => collidedPage.flashes.filter(({ shown }) => shown).length >= count, wanted), 60);
  const late = (await page.evaluate(() => collidedPage.flashes.filter(({ shown }) => shown).map(({ time, shown }) => (shown - time) * 1000))).sort((a, b) => a - b);
  const median = late[Math.floor(late.length / 2)];
  console.log(`flashes: ${late.length}, shown after ${median.toFixed(0)} ms (median), ${late.at(-1).toFixed(0)} ms at most`);
  check(median >= 0, "a contact flashes before it begins");
  // A picture drawn without a graphics card on a machine that others keep busy says nothing about the page.
  if (!isLong && loadavg()[0] > cpus().length) return console.log(`  not judged: ${loadavg()[0].toFixed(1)} programs want ${cpus().length} processors`);
  check(median <= 200, `a contact flashes after ${median} ms; allowed 200`);
}

/// Places of the picture, from its upper left, where something that stands still is seen.
const standingPlaces = (page) => page.evaluate(() => {
  const found = [];
  for (let x = 0.1; x < 0.7; x += 0.03) {
    for (let y = 0.45; y < 0.85; y += 0.03) {
      const seen = collidedPage.picture.renderer.pick(x, y);
      const object = seen && collidedPage.world.objects.get(seen.slot);
      if (object && !object.moving) found.push([x, 1 - y, object.name]);
    }
  }
  return found;
});

/// A click on something that stands still; the same ray asked by the command line gives the same numbers.
async function clicksAreAnswered(page) {
  const canvas = await page.locator("#scene").boundingBox();
  const places = await standingPlaces(page);
  check(places.length > 0, "nothing that stands still is in the picture");
  let equal = 0;
  for (const [x, y] of places.filter((_, i) => i % Math.ceil(places.length / 5) === 0)) {
    await page.evaluate(() => { collidedPage.asking.lastAnswer = null; });
    await page.mouse.click(canvas.x + x * canvas.width, canvas.y + y * canvas.height);
    const answer = await until("the click is answered", () => page.evaluate(() => collidedPage.asking.lastAnswer)).catch(async (failed) => {
      throw new Error(`${failed.message}; at ${x} ${y}, the page says: ${await page.locator("#answer").textContent()}`);
    });
    if (answer.answer === "hit" && (await page.evaluate((name) => collidedPage.world.byName.get(name)?.moving, answer.object))) continue;
    const said = collide("ray", ...answer.origin.map(String), ...answer.direction.map(String), "--json");
    const theirs = JSON.parse(said.stdout);
    // Something that moves may have come into the way since.
    if (theirs.answer === "hit" && (await page.evaluate((name) => collidedPage.world.byName.get(name)?.moving, theirs.object))) continue;
    for (const member of ["answer", "object", "distance", "error", "point", "normal", "triangle", "point_error"]) {
      const [ours, other] = [answer[member], theirs[member]].map((value) => JSON.stringify(value));
      check(ours === other, `click: ${member} is ${ours}, the command line says ${other}`);
    }
    check((await page.locator("#answer").textContent()).includes(answer.answer), "the answer is not shown");
    ++equal;
  }
  check(equal >= 3, `only ${equal} clicks could be compared`);
  console.log(`clicks: ${equal} answers equal to the command line's, member by member`);
}

/// The command that the page shows beside an answer gives the same numbers, whatever was asked.
async function commandsGiveTheSame(page) {
  const canvas = await page.locator("#scene").boundingBox();
  const places = await standingPlaces(page);
  const isMoving = (name) => page.evaluate((which) => collidedPage.world.byName.get(which)?.moving, name);
  const comparedOf = {};
  for (const [tool, clicks] of [["sphere", 1], ["box", 1], ["near", 1], ["sweep", 2], ["pair", 2]]) {
    await page.selectOption("#tool", tool);
    if (tool !== "near" && tool !== "pair") await page.fill("#tool-size", "0.3");
    comparedOf[tool] = 0;
    for (let i = 0; i + 1 < places.length && comparedOf[tool] < 2; i += Math.ceil(places.length / 8)) {
      await page.evaluate(() => {
        collidedPage.asking.lastAnswer = null;
        collidedPage.choose(null);
      });
      const spots = [places[i], places.find(([, , name]) => name !== places[i][2])].slice(0, clicks);
      for (const [x, y] of spots) await page.mouse.click(canvas.x + x * canvas.width, canvas.y + y * canvas.height);
      // Where something moves in between, two clicks may mean one thing, of which nothing is asked.
      const answer = await until(`the ${tool} is answered`, () => page.evaluate(() => collidedPage.asking.lastAnswer), 10).catch(() => null);
      if (!answer) continue;
      const command = await page.locator("#answer-command").textContent();
      const said = spawnSync("bash", ["-c", `collide() { "$COLLIDE" "$@"; }; ${command} --json`], { env: { ...environment, COLLIDE: words.collide }, encoding: "utf8", timeout: 20000 });
      const theirs = said.stdout.trim().split("\n").map((line) => JSON.parse(line));
      const ours = answer.hits ?? [answer];
      const movers = await Promise.all([...ours, ...theirs].map(({ object }) => object && isMoving(object)));
      if (movers.some(Boolean) || (!answer.hits?.length && tool !== "pair")) continue;
      const number = (one) => one.depth ?? one.distance ?? one.time_low;
      const isSweep = tool === "sweep";
      ours.forEach((hit, k) => {
        const [a, b] = [hit, theirs[k]].map((one) => JSON.stringify([one.object, isSweep ? [one.time_low, one.time_high] : number(one), isSweep ? 0 : one.error, one.point]));
        check(a === b, `${command}: the page says ${a}, the command ${b}`);
      });
      ++comparedOf[tool];
    }
    check(comparedOf[tool] > 0, `no ${tool} could be compared`);
  }
  await page.selectOption("#tool", "ray");
  await page.keyboard.press("Escape");
  console.log(`commands: as the page says (${Object.entries(comparedOf).map(([tool, count]) => `${tool} ${count}`).join(", ")})`);
}

async function namesWhatIsUnderThePointer(page) {
  const canvas = await page.locator("#scene").boundingBox();
  const place = await page.evaluate(() => {
    for (let x = 0.1; x < 0.7; x += 0.02) for (let y = 0.2; y < 0.8; y += 0.02) if (collidedPage.picture.renderer.pick(x, y)) return [x, 1 - y];
  });
  await page.mouse.move(canvas.x + place[0] * canvas.width, canvas.y + place[1] * canvas.height);
  await until("the label names an object and its distance", async () => / from the eye/.test(await page.locator("#label").textContent()));
  await page.mouse.move(5, 5);
}

async function turnsAndZooms(page) {
  const eye = () => page.evaluate(() => collidedPage.camera.eye().join());
  const before = await eye();
  const canvas = await page.locator("#scene").boundingBox();
  await page.mouse.move(canvas.x + 300, canvas.y + 300);
  await page.mouse.down();
  await page.mouse.move(canvas.x + 380, canvas.y + 330, { steps: 4 });
  await page.mouse.up();
  const dragged = await eye();
  check(dragged !== before, "dragging turns nothing");
  await page.keyboard.press("ArrowLeft");
  const pressed = await eye();
  check(pressed !== dragged, "keys turn nothing");
  await page.mouse.wheel(0, -200);
  await until("the wheel goes nearer", async () => (await eye()) !== pressed);
  await page.keyboard.press("f");
}

async function showsItsPanels(page) {
  await until("events are listed", () => page.evaluate(() => document.querySelectorAll("#events li").length >= 3));
  await until("stages are shown", () => page.evaluate(() => document.querySelectorAll("#stages .bar").length === 6));
  await until("publishers are shown", async () => /homework/.test(await page.locator("#publishers").textContent()));
  await until("pairs are drawn", () => page.evaluate(() => collidedPage.matrix.text?.split("\n").length >= 3));
}

/// Stopped and going on: said, and then shown as before.
async function survivesAStall(page, server, seconds) {
  server.kill("SIGSTOP");
  await until("the stall is said", async () => /no server answers/.test(await state(page)), 15);
  await new Promise((done) => setTimeout(done, 1000 * seconds));
  server.kill("SIGCONT");
  await until("the server is back", () => isReady(page), 20);
  await moves(page);
  console.log(`stall: survived ${seconds} s without a server`);
}

async function survivesARestart(page, server) {
  const epoch = await page.evaluate(() => collidedPage.epoch);
  server.kill("SIGKILL");
  await server.ended;
  const begun = Date.now();
  const next = await startServer();
  await until("the new server is shown", async () => (await isReady(page)) && (await page.evaluate(() => collidedPage.epoch)) !== epoch, 40);
  await until("its objects are there", () => page.evaluate(() => collidedPage.world.objects.size > 30));
  await moves(page);
  console.log(`restart: objects of the new server move ${((Date.now() - begun) / 1000).toFixed(1)} s after its start`);
  return next;
}

/// The time from picture to picture while everything moves.
async function drawsManyInTime(page, crowd) {
  await until("the crowd is there", () => page.evaluate((count) => collidedPage.world.objects.size > count, crowd), 30);
  await moves(page);
  await page.evaluate(() => { collidedPage.picture.frames.length = 0; });
  await until("pictures are drawn", () => page.evaluate(() => collidedPage.picture.frames.length >= 60), 40);
  const { median, worst, sharpness, graphics } = await page.evaluate(() => {
    const frames = collidedPage.picture.frames.slice(-40).sort((a, b) => a - b);
    const gl = collidedPage.picture.renderer.gl;
    const told = gl.getExtension("WEBGL_debug_renderer_info");
    return { median: frames[20], worst: frames.at(-2), sharpness: collidedPage.picture.motionSharpness, graphics: told ? gl.getParameter(told.UNMASKED_RENDERER_WEBGL) : "?" };
  });
  const isSoftware = /swiftshader|llvmpipe|software/i.test(graphics);
  console.log(`crowd: ${crowd} objects, ${median.toFixed(0)} ms a picture (median), ${worst.toFixed(0)} ms worst but one, sharpness ${sharpness.toFixed(2)}, ${graphics}`);
  const allowed = isSoftware ? 150 : 1000 / 30;
  check(median <= allowed, `${median} ms a picture; allowed ${allowed}`);
}

async function savedRunsPlay(browser) {
  const file = join(scratch, "run.html");
  const said = collide("view", "--save", file, "--last", "2s");
  check(said.status === 0, `--save: ${said.stderr}`);
  const [, seconds, frames] = said.stdout.split("\t").map(Number);
  check(frames >= 5 * seconds, `--save: ${frames} frames in ${seconds} s`);
  const page = await browser.newPage({ viewport: { width: 1000, height: 640 } });
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) wrong.push(`asks for ${request.url()}`); });
  await page.goto(`file://${file}`);
  await until("the saved run is there", () => page.evaluate(() => collidedPage.isUnpacked && collidedPage.world.objects.size > 30 && collidedPage.world.worldTime > 0));
  const places = [];
  for (const at of [0.3, 1.2, 0.3]) {
    await page.evaluate((seconds) => {
      collidedPage.timeline.pause();
      collidedPage.timeline.goTo(seconds);
    }, at);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    places.push((await positions(page)).join(" "));
  }
  check(places[0] !== places[1], "nothing moves in the saved run");
  check(places[0] === places[2], "going back shows something else than before");
  check(wrong.length === 0, wrong.join("; "));
  console.log(`saved: ${(readFileSync(file).length / 1e6).toFixed(1)} MB play by themselves, forwards and back`);
  if (words.pictures) await page.screenshot({ path: join(words.pictures, "saved.png") });
  await page.close();
}

/// Shapes that recordings have in another form than the server shows them: a hull, a height field, voxels.
async function addEveryKind(page) {
  const write = (name, text) => {
    writeFileSync(join(scratch, name), text);
    return join(scratch, name);
  };
  const tent = write("tent.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 2 1 0\nv 0 0.5 1\nv 2 0.5 1\nv 1 0.5 0.4\nf 1 2 3\nf 4 5 6\nf 1 2 7\n");
  const hills = write("hills.txt", "0 0.1 0.2 0\n0.3 0.4 0.1 0\n0 0.2 0 0.1\n");
  for (const [name, shape, at] of [["tent", ["hull", tent], "-6"], ["hills", ["heights", hills, "0.5", "0.7"], "-4"]]) {
    const said = collide("add", name, ...shape, "--at", at, "-4", "0.5");
    check(said.status === 0, `add ${name}: ${said.stderr}`);
  }
  const points = Array.from({ length: 400 }, (_, i) => `${3 + 0.9 * Math.sin(i)} ${-4 + 0.9 * Math.sin(1.7 * i)} ${1 + 0.4 * Math.sin(2.3 * i)}`);
  start(words.collide, ["publish", write("scan.xyz", `${points.join("\n")}\n`), "--voxels", "0.25", "--as", "scan"]);
  await until("they are shown", () => page.evaluate(() => ["tent", "hills"].every((name) => collidedPage.world.byName.has(name)) && [...collidedPage.world.objects.values()].some(({ publisher, name, parts }) => /^scan/.test(publisher ?? name) && parts.length > 1)), 30);
}

/// Recordings, of a file and of the server's own memory, show the objects and shapes that the server showed.
async function opensRecordings(page) {
  const told = () => page.evaluate(() => {
    // Of the triangles of a surface from a number on: a hull may be cut into others.
    const area = ([number, first, count]) => {
      const { positions, corners } = collidedPage.timeline.shownTable.surfaceOf(number);
      let sum = 0;
      for (let i = 3 * first; i < 3 * (first + count); i += 3) {
        const [a, b, c] = [0, 1, 2].map((k) => positions.subarray(3 * corners[i + k], 3 * corners[i + k] + 3));
        const [u, v] = [b, c].map((corner) => [0, 1, 2].map((axis) => corner[axis] - a[axis]));
        sum += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
      }
      return Number(sum.toPrecision(5));
    };
    return Object.fromEntries([...collidedPage.world.objects.values()].map(({ name, parts, moving, runs }) => [name, JSON.stringify([moving, runs.map(area), parts.map((part) => part.map((n) => Number(n.toFixed(9))))])]));
  });
  await addEveryKind(page);
  const fenced = collide("fence", "add", "yard", "box", "0", "0", "0", "3", "3", "3", "--keep");
  check(fenced.status === 0, `fence: ${fenced.stderr}`);
  const standing = () => page.evaluate(() => JSON.stringify(collidedPage.standing.all.map(({ name, lines }) => [name, lines.map((line) => line.map(Number))])));
  await until("the fence is shown", () => page.evaluate(() => collidedPage.standing.all.length === 1));
  const liveStanding = await standing();
  const live = await told();
  const file = join(scratch, "run.mcap");
  const said = collide("record", file, "--for", "1500ms");
  check(said.status === 0, `record: ${said.stderr}`);
  const shows = async (which) => {
    await until(`${which} is shown`, async () => (await page.locator("#recording").textContent()).includes(which) && (await page.locator("#recording").isVisible()), 30);
    // At its end: what it begins with may be older than what was added above.
    await page.evaluate(() => {
      collidedPage.timeline.pause();
      collidedPage.timeline.goTo(collidedPage.timeline.end());
    });
    await until("its objects are there", () => page.evaluate((count) => collidedPage.world.objects.size === count, Object.keys(live).length));
    const shown = await told();
    for (const [name, text] of Object.entries(live)) check(shown[name] === text, `${which}: ${name} is ${shown[name]}, the server says ${text}`);
    // A short one may have come to its end by now: its instants are compared.
    const places = [];
    for (const part of [0.1, 0.9]) {
      await page.evaluate((fraction) => {
        const { timeline } = collidedPage;
        timeline.pause();
        timeline.goTo(timeline.begin() + fraction * (timeline.end() - timeline.begin()));
      }, part);
      await until("its poses are applied", () => page.evaluate(() => !collidedPage.pendingPoses));
      places.push((await positions(page)).join(" "));
    }
    check(places[0] !== places[1], `${which}: nothing moves`);
    check(await page.evaluate(() => collidedPage.timeline.history.eventsUntil(Infinity, 5).length > 0), `${which}: no events`);
  };
  await page.setInputFiles("#file", file);
  await shows("run.mcap");
  check(await standing() === liveStanding, `run.mcap: the standing questions are ${await standing()}, live they were ${liveStanding}`);
  check(collide("fence", "rm", "yard").status === 0, "fence rm");
  await page.click("#live");
  await until("the page is live again", async () => (await page.locator("#recording").isHidden()) && (await isReady(page)));
  await page.click("#memory");
  await shows("last 30 s");
  console.log(`recordings: a file, and ${await page.evaluate(() => collidedPage.timeline.history.end.toFixed(1))} s of the server's memory`);
  await page.click("#live");
  await moves(page);
}

/// What commands did while it was recorded, refused ones too, and what lay within a solid when it began.
async function showsWhatCommandsDid(page) {
  const run = (code, ...args) => {
    const said = collide(...args);
    check(said.status === code, `${args.join(" ")}: ${said.status} ${said.stderr}`);
  };
  const cube = join(scratch, "pod.obj");
  const sides = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
  writeFileSync(cube, `${[0, 1, 2, 3, 4, 5, 6, 7].map((k) => `v ${2 * (k & 1) - 1} ${(k & 2) - 1} ${((k & 4) >> 1) - 1}`).join("\n")}\n${sides.flatMap(([a, b, c, d]) => [`f ${a} ${b} ${c}`, `f ${a} ${c} ${d}`]).join("\n")}\n`);
  run(0, "add", "pod", "mesh", cube, "--at", "20", "0", "1", "--solid");
  run(0, "add", "pea", "sphere", "0.1", "--at", "20.2", "0", "1");
  const file = join(scratch, "commands.mcap");
  const recorder = start(words.collide, ["record", file, "--for", "1min"]);
  // It writes a head, what was there before, and then what comes, piece by piece.
  const growsBy = (pieces) => {
    const sizes = new Set();
    return until("it records", () => existsSync(file) && sizes.add(statSync(file).size).size > pieces);
  };
  await growsBy(4);
  // All commands come from one program: a recorder misses the first question of a program that it has not met yet.
  const lines = start(words.collide, ["-"], "pipe");
  const say = (line) => lines.stdin.write(`${line}\n`);
  await until("the recorder has met the program", () => {
    say("ls canary");
    return readFileSync(file).includes("canary");
  });
  for (const line of ["add crate_1 sphere 0.2 --at 22 0 0.5", "add crate_2 sphere 0.2 --at 23 0 0.5",
    "add crate_1 box 1 1 1 --at 24 0 0.5", "attach crate_2 pea", "move pea 27 0 1"]) say(line);
  await until("the pea has moved", () => collide("get", "pea", "--json").stdout.includes('"position":[27'));
  await new Promise((done) => setTimeout(done, 500));
  say("rm crate_*");
  lines.stdin.end();
  await lines.ended;
  check(lines.said.includes("server refused"), `nothing was refused: ${lines.said.slice(-300)}`);
  await growsBy(3);
  recorder.kill("SIGINT");
  await recorder.ended;
  await page.setInputFiles("#file", file);
  await until("the recording is shown", async () => (await page.locator("#recording").textContent()).includes("commands.mcap"), 30);
  const found = await page.evaluate(async () => {
    const { timeline } = collidedPage;
    timeline.pause();
    const shown = async (t) => {
      timeline.goTo(t);
      while (collidedPage.pendingPoses) await new Promise(requestAnimationFrame);
      const { world, contacts } = collidedPage;
      const [one, two] = ["crate_1", "crate_2"].map((name) => world.byName.get(name));
      return { kind: one?.parts[0][0], x: two && Number(two.position[0].toFixed(3)), pea: contacts.of("pea").map(({ contained }) => Boolean(contained)).join() };
    };
    const all = [];
    for (let t = timeline.begin(); t < timeline.end(); t += 0.02) all.push(await shown(t));
    return { first: all[0], all, last: await shown(timeline.end()) };
  });
  check(found.first.pea === "true", `the pea is told to be ${found.first.pea ? "outside" : "without contact"}, not in the pod`);
  check(found.all.every(({ kind }) => kind === undefined || kind === 0), "a refused box is shown");
  check(found.all.some(({ x }) => x === 29.8), `what is attached does not go along: ${[...new Set(found.all.map(({ x }) => x))].join(", ")}`);
  check(found.last.kind === undefined && found.last.x === undefined, "what a removal by a glob took is still shown");
  check(found.last.pea === "", "the pea is out of the pod, and has a contact");
  await page.click("#live");
  for (const name of ["pea", "pod"]) run(0, "rm", name);
  console.log("recorded commands: an attachment, a refusal, a removal by a glob, and what lies within what");
}

async function drawsWithoutWebGL(url) {
  const browser = await launch(["--disable-3d-apis"]);
  const page = await browser.newPage({ viewport: { width: 1000, height: 640 } });
  await page.goto(url);
  await until("the drawing is shown", () => page.evaluate(() => document.getElementById("drawing").naturalWidth > 0), 20);
  await until("the panels go on", () => page.evaluate(() => document.querySelectorAll("#events li").length > 0), 20);
  if (words.pictures) await page.screenshot({ path: join(words.pictures, "drawing.png") });
  await browser.close();
  console.log("without WebGL: the drawing and the panels");
}

async function run() {
  let server = await startServer();
  start(words.collide, ["publish", "--spheres", "16", "--side", "3", "--size", "0.18", "--speed", "1.5", "--round", "--bounce", "--rate", "60", "--as", "homework", "--name", "ball"]);
  start(words.collide, ["publish", "--waypoints", "6,-3,0.8 6,3,0.8 2,3,1.5 2,-3,0.5", "--loop", "--speed", "2", "--shape", "capsule:0.3,1", "--name", "visitor", "--as", "pilot"]);
  const { url } = await startViewer();
  const browser = await launch();
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("console", (message) => { if (message.type() === "error" && !/WebSocket|ERR_|404/.test(message.text())) wrong.push(message.text()); });
  await page.goto(`${url}/#theme=paper`, { waitUntil: "commit" });
  await seesTheWorld(page);
  await showsItsPanels(page);
  await flashesInTime(page);
  await namesWhatIsUnderThePointer(page);
  await clicksAreAnswered(page);
  await commandsGiveTheSame(page);
  await picture(page, "paper");
  await turnsAndZooms(page);
  await page.keyboard.press("t");
  await moves(page);
  await picture(page, "night");
  await page.keyboard.press("t");
  await opensRecordings(page);
  await showsWhatCommandsDid(page);
  await survivesAStall(page, server, isLong ? 10 : 1);
  server = await survivesARestart(page, server);
  await savedRunsPlay(browser);
  await drawsWithoutWebGL(url);
  if (isLong) {
    start(words.collide, ["publish", "--spheres", "2000", "--side", "12", "--size", "0.02", "--round", "--rate", "60", "--as", "crowd", "--name", "many"]);
    await drawsManyInTime(page, 2000);
    await picture(page, "crowd");
  }
  const shapeless = await page.evaluate(() => [...collidedPage.world.objects.values()].filter((o) => o.runs.some(([number]) => !collidedPage.source.surfaces.known.has(`${collidedPage.epoch} ${number}`))).length);
  check(shapeless === 0, `${shapeless} objects without their surfaces`);
  check(wrong.length === 0, `the page's errors: ${wrong.join("; ")}`);
  await browser.close();
}

await runAndStop("view", run);
