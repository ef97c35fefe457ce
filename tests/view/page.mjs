// The page in a real browser, with a viewer made here, so that each test knows what must be seen.
//   node page.mjs --source client/view --modules DIR [--pictures DIR]
import { loadavg } from "node:os";
import { check, launch, picture, until, words } from "./chromium.mjs";
import { FakeWorld, kAddress, pageFiles } from "./fake_viewer.mjs";

const files = pageFiles(words.source);
const kHostile = ["<img src=x onerror=\"window.isBroken=1\">", "\u202egnp.exe", "مرحبا بالعالم", "x".repeat(255)];

function hall() {
  return new FakeWorld()
    .box("floor", [0, 0, -0.1], [6, 4, 0.1], { scene: "hall" })
    .box("site", [0, 0, -0.1], [8, 5, 0.1], { scene: "hall" })
    .box("shelf_1", [-3, 1, 0.75], [0.5, 0.3, 0.75], { scene: "hall" })
    .box("shelf_2", [3, 1, 0.75], [0.5, 0.3, 0.75], { scene: "hall" })
    .sphere("ball_1", [0, 0, 0.5], 0.4)
    .sphere("ball_2", [1.5, 0, 0.5], 0.4);
}

let browser;
const wrong = [];
async function open(world, { width = 1280, height = 800, touch = false, night = false, answers = {} } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, hasTouch: touch, isMobile: touch, deviceScaleFactor: touch ? 2 : 1, colorScheme: night ? "dark" : "light" });
  const page = await context.newPage();
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("console", (message) => { if (message.type() === "error") wrong.push(message.text()); });
  page.on("request", (request) => { if (!request.url().startsWith(kAddress) && !request.url().startsWith("data:")) wrong.push(`asks for ${request.url()}`); });
  await world.serve(page, files, answers);
  await page.goto(kAddress, { waitUntil: "commit", timeout: 60000 });
  await until("the objects are there", () => page.evaluate((count) => window.collidedPage?.world.objects.size === count, world.objects.length), 90);
  await until("a picture is drawn", () => page.evaluate(() => Boolean(collidedPage.picture.renderer.whole)));
  return page;
}
const shut = (page) => page.context().close();
const textOf = (page, selector) => page.evaluate((which) => document.querySelector(which).textContent, selector);
const bring = (page, name) => page.evaluate((which) => collidedPage.choose(collidedPage.world.byName.get(which).slot), name);

// ---- the picture

/// When nothing moves the picture has every pixel of the screen, whatever it had while things moved.
async function restsAtFullResolution() {
  const page = await open(hall());
  await page.evaluate(() => {
    collidedPage.picture.motionSharpness = 0.4;
    collidedPage.changed();
  });
  await until("the picture is sharp", () => page.evaluate(() => collidedPage.picture.renderer.sharpness >= 1), 60);
  const { canvas, screen, text } = await page.evaluate(() => ({ canvas: document.getElementById("scene").width, screen: document.getElementById("scene").clientWidth, text: collidedPage.picture.qualityText() }));
  check(canvas >= screen, `the picture has ${canvas} columns of pixels, the screen ${screen}`);
  check(/full resolution/.test(text), `it is not said: ${text}`);
  await page.evaluate(() => { collidedPage.picture.renderer.sharpness = 0.4; });
  check(/40 % of the pixels/.test(await page.evaluate(() => collidedPage.picture.qualityText())), "a coarser picture is not said to be one");
  await shut(page);
}

/// Of two floors with the same upper side the smaller one is seen, wherever one looks.
async function coincidingFacesDoNotFlicker() {
  const page = await open(hall());
  for (const pitch of [0.7, 0.25, 1.4]) {
    const seen = await page.evaluate(async (to) => {
      const { camera, picture, world } = collidedPage;
      camera.pitch = to;
      camera.isTouched = true;
      collidedPage.changed();
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      const found = {};
      for (let x = -5.8; x <= 5.8; x += 0.58) {
        for (let y = -3.8; y <= 3.8; y += 0.38) {
          const place = camera.project([x, y, 0]);
          const hit = picture.renderer.pick((place[0] + 1) / 2, (place[1] + 1) / 2);
          const name = hit ? world.objects.get(hit.slot).name : "nothing";
          found[name] = (found[name] || 0) + 1;
        }
      }
      return found;
    }, pitch);
    check(seen.floor > 200, `hardly any floor in the picture: ${JSON.stringify(seen)}`);
    check(!seen.site, `pitch ${pitch}: the site shines through the floor at ${seen.site} of ${seen.floor + seen.site} places`);
  }
  await shut(page);
}

/// Draws what is round as points up to so many pixels, and as boxes; in how many pixels the two differ.
const pointsAgainstBoxes = (page) => page.evaluate(() => {
  const { picture, camera, world } = collidedPage;
  const { renderer } = picture;
  const slots = (mostPoint) => {
    Object.assign(renderer, { mostPoint, sharpness: 1 });
    world.viewKey = null;
    renderer.resize();
    world.send(camera, renderer.seenSize);
    for (const name of ["roundPoint", "roundBox", "ballPoint"]) renderer.programs[name] ||= renderer.begun(...renderer.sources[name]);
    const isReady = renderer.prepare() && ["roundPoint", "roundBox", "ballPoint"].every((name) => renderer.programs[name].places || renderer.finish(renderer.programs[name]));
    if (!isReady) return null;
    renderer.draw(camera, { ...picture.depths(world, camera), anchor: world.anchor, ground: 0, grid: 1, stillVersion: mostPoint, region: null });
    const [width, height] = renderer.seenSize;
    const numbers = new Uint32Array(4 * width * height);
    const { gl } = renderer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.whole.buffer);
    gl.readPixels(0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, numbers);
    return numbers.filter((_, i) => i % 4 === 0);
  };
  const small = () => ["stillSolids", "movingSolids"].reduce((sum, of) => sum + renderer[of].balls.small + renderer[of].round.small, 0);
  const points = slots(400);
  const pointCount = small();
  const boxes = points && slots(0);
  if (!boxes) return null;
  return { pointCount, boxCount: small(), differ: points.reduce((sum, slot, i) => sum + (slot !== boxes[i] ? 1 : 0), 0), covered: boxes.reduce((sum, slot) => sum + (slot > 1 ? 1 : 0), 0) };
});

/// What is round and small is drawn as points; it covers the same pixels as what is cast inside boxes.
async function smallRoundThingsAreTheSame() {
  const world = new FakeWorld().box("floor", [0, 0, -0.1], [9, 9, 0.1], { scene: "hall" });
  const ends = [0, 0, -0.3, 0.2, 0.1, 0.3, 0.15];
  const parts = [[0, 0, 0, 0, 0.3], [2, ...ends], [3, ...ends], [4, ...ends], [5, 0, 0, 0, 0.8, 0.6, 0, 0, 0.4, 0.2, 0.1]];
  for (let i = 0; i < 100; ++i) world.add(`thing_${i}`, parts[i % 5], { moving: i % 2 === 0, at: [(i % 10) * 1.8 - 8, Math.floor(i / 10) * 1.8 - 8, 0.5 + 0.003 * i] });
  const page = await open(world, { width: 720, height: 480 });
  for (const [yaw, distance] of [[-0.9, 22], [0.4, 9], [2, 4]]) {
    await page.evaluate(([to, far]) => Object.assign(collidedPage.camera, { yaw: to, distance: far, isTouched: true }), [yaw, distance]);
    const { pointCount, boxCount, differ, covered } = await until("the shaders are there", () => pointsAgainstBoxes(page), 60);
    check(pointCount > 0 && boxCount === 0, `${pointCount} points, then ${boxCount}`);
    check(covered > 1000, `only ${covered} pixels show something`);
    // Where a ray grazes a side, or two things meet in a pixel, the arithmetic of either way may decide otherwise.
    check(differ <= 2e-4 * covered, `from ${distance} m: ${differ} of ${covered} pixels show something else`);
  }
  await shut(page);
}

/// Ten thousand things move, and each is one point for the graphics card.
async function tenThousandMove() {
  const count = 10000;
  const world = new FakeWorld().box("floor", [0, 0, -0.1], [60, 60, 0.1], { scene: "hall" });
  for (let i = 0; i < count; ++i) world.sphere(`carrier_${i}`, [(i % 100) - 50, Math.floor(i / 100) - 50, 0.3], 0.3);
  const page = await open(world);
  const { pictures, seconds, small } = await page.evaluate(async (all) => {
    const { picture, timeline, world: { movers } } = collidedPage;
    const home = movers.map(({ position }) => [...position]);
    const slots = Uint32Array.from(movers, ({ slot }) => slot);
    let version = 1000;
    const feeder = setInterval(() => {
      const numbers = new Float32Array(7 * all);
      for (let i = 0; i < all; ++i) numbers.set([home[i][0] + Math.sin(version / 20 + i), home[i][1], home[i][2], 1], 7 * i);
      timeline.hear("poses", { count: all, worldTime: version / 30, tableVersion: 1, version: ++version, origin: [0, 0, 0], numbers, slots, stale: new Uint8Array(all) });
    }, 33);
    const begun = performance.now();
    picture.frames.length = 0;
    while (picture.frames.length < 25 && performance.now() - begun < 30000) await new Promise(requestAnimationFrame);
    clearInterval(feeder);
    return { pictures: picture.frames.length, seconds: (performance.now() - begun) / 1000, small: picture.renderer.movingSolids.balls.small };
  }, count);
  check(small === count, `${small} of ${count} are points`);
  check(pictures >= 25, `${pictures} pictures in ${seconds} s`);
  console.log(`crowd: ${count} movers, ${(pictures / seconds).toFixed(1)} pictures a second, ${loadavg()[0].toFixed(1)} programs at work`);
  await shut(page);
}

/// Many contacts in one place are one mark with their number; what is hidden has none; a touch is called one.
async function contactsAreClustered() {
  const world = hall();
  const page = await open(world);
  const events = [0, 1, 2, 3, 4].map((i) => world.event("began", "ball_1", i ? `shelf_${1 + (i % 2)}` : "floor", { point: [0.002 * i, 0, 0.1] }));
  world.tell({ type: "events", left_out: 0, events: [...events.slice(0, 3), world.event("began", "ball_2", "shelf_2", { point: [1.5, 0, 0.1], depth: 0 })] });
  await until("the number stands at the mark", () => page.evaluate(() => collidedPage.picture.labels.placed.some(([, , , , text]) => text === "3")), 40);
  const marks = await page.evaluate(() => collidedPage.picture.marks.count);
  check(marks < 12, `${marks} marks for two places`);
  await page.evaluate(() => collidedPage.things.hide([collidedPage.world.byName.get("ball_1")], true));
  await until("what is hidden has no marks", () => page.evaluate(() => collidedPage.picture.labels.placed.every(([, , , , text]) => text !== "3")), 40);
  await until("the touch is told", async () => /touching/.test(await textOf(page, "#events")));
  check(!/ 0 deep|0 m deep/.test(await textOf(page, "body")), "a touch is told as 0 deep");
  await shut(page);
}

const circles = (radius) => [[1, 0], [0, 2], [1, 2]].map(([u, v]) => Array.from({ length: 33 }, (_, i) => {
  const point = [0, 0, 0];
  point[u] = radius * Math.cos((2 * Math.PI * i) / 32);
  point[v] = radius * Math.sin((2 * Math.PI * i) / 32);
  return point;
}).flat());
const boxLines = (low, high) => [0, 1, 2].flatMap((axis) => [0, 1, 2, 3].map((corner) => {
  const point = [0, 1, 2].map((each) => (each === axis ? low[each] : ((corner >> (each === (axis + 1) % 3 ? 0 : 1)) & 1 ? high : low)[each]));
  const end = [...point];
  end[axis] = high[axis];
  return [...point, ...end];
}));
const fence = (name, lines, more = {}) => ({ name, to: "", inside: [], in_doubt: [], lines, ...more });

/// Fences are outlines that are lit and listed first while something is in them, and go where their carrier goes; going
/// back in time shows who was in then.
async function fencesAreLitWhileEntered() {
  const world = hall();
  const page = await open(world);
  const accents = () => page.evaluate(() => {
    const { data, count } = collidedPage.picture.marks;
    const of = (accent) => Array.from({ length: count }, (_, i) => data[10 * i + 9]).filter((one) => one === accent).length;
    return [of(0), of(1)];
  });
  check(await page.evaluate(() => document.getElementById("panel-fences").hidden), "fences are listed though there are none");
  const dock = boxLines([1, -1, 0], [4, 2, 1.6]);
  const all = (inside) => [
    fence("gate", boxLines([-4, -2, 0], [-2, -1, 1])), fence("dock", dock, { inside }),
    fence("close", circles(1.2), { to: "ball_1", within: 0.8 }), fence("nobody's", circles(1), { to: "not there" }), fence(kHostile[0], circles(0.2)),
  ];
  world.tell({ type: "fences", fences: all([]) });
  await until("they are drawn", async () => (await accents())[0] === 24 + 2 * 96);
  check((await accents())[1] === 0, "an empty fence is lit");
  const before = await page.evaluate(() => performance.now() / 1000);
  world.tell({ type: "fences", fences: all(["ball_2"]) });
  await until("the entered one is lit", async () => (await accents()).join() === `${12 + 2 * 96},12`);
  await page.evaluate((t) => {
    collidedPage.timeline.pause();
    collidedPage.timeline.goTo(t);
  }, before);
  await until("it was empty then", async () => (await accents())[1] === 0);
  await page.evaluate(() => collidedPage.timeline.live());
  await until("and is entered now", async () => (await accents())[1] === 12);
  await until("it is listed first", async () => /^dockball_2/.test(await textOf(page, "#fences")));
  check(/5, 1 entered/.test((await textOf(page, "#fence-count")).replace(/\u2009/g, "")), "the count is not told");
  check((await page.evaluate(() => document.querySelector("#fences").innerHTML)).includes("&lt;img"), "a name is read as HTML");
  await picture(page, "fences_entered");
  world.objects.find(({ name }) => name === "ball_1").pose[0] = -1;
  world.move(2);
  await until("the band goes along", () => page.evaluate(() => {
    const { data, count } = collidedPage.picture.marks;
    const { anchor } = collidedPage.world;
    let least = Infinity;
    for (let i = 0; i < count; ++i) if (data[10 * i + 8] < 0.35) least = Math.min(least, data[10 * i] + anchor[0]);
    return Math.abs(least - (-1 - 1.2)) < 1e-3;
  }));
  await page.click("#fences .link");
  check(await page.evaluate(() => Math.abs(collidedPage.camera.target[0] - 2.5) < 1e-6), "a click does not go to the fence");
  world.tell({ type: "fences", fences: all([]) });
  await until("it is empty again", async () => (await accents())[1] === 0);
  await picture(page, "fences_empty");
  world.tell({ type: "fences", fences: [] });
  await until("none is left", () => page.evaluate(() => document.getElementById("panel-fences").hidden));
  await shut(page);
}

/// What is under the pointer is compared with what was chosen; an overlap of two that never meet is no contact.
async function overlapsThatAreNoContactsAreSaidSo() {
  const world = hall().sphere("ghost", [0, 0, 0.5], 0.6, { layers: 2, mask: 2 });
  const page = await open(world, { answers: { pair: () => ({ answer: "hit", depth: 0.5, error: 1e-16, point: [0, 0, 0] }) } });
  for (const [a, b, expected] of [["ghost", "ball_1", /never meet/], ["floor", "site", /never meet/], ["ball_1", "ball_2", /500.0 mm deep/]]) {
    await bring(page, a);
    const gap = await page.evaluate(async (other) => {
      collidedPage.hovered = collidedPage.world.byName.get(other).slot;
      collidedPage.asking.isAskingGap = false;
      collidedPage.asking.askGap();
      await new Promise((done) => setTimeout(done, 400));
      return collidedPage.asking.gap;
    }, b);
    check(expected.test(gap), `${a} and ${b}: ${gap}`);
  }
  await shut(page);
}

// ---- things

async function hostileNamesAreOnlyNames() {
  const world = hall();
  kHostile.forEach((name, i) => world.sphere(name, [i - 2, -2, 0.5], 0.3));
  const page = await open(world);
  world.tell({ type: "events", left_out: 0, events: kHostile.map((name) => world.event("began", name, "floor")) });
  world.tell(world.status({ scenes: [kHostile[0]], publishers: kHostile.map((name) => ({ name, messages: 1, silent: 0.1, lost: false })) }));
  await bring(page, kHostile[3]);
  await page.evaluate(() => document.getElementById("labels").click());
  await until("they are all listed", async () => (await textOf(page, "#publishers")).includes("مرحبا"));
  await until("they are events", async () => (await textOf(page, "#events")).includes("مرحبا"));
  check(await page.evaluate(() => !window.isBroken && document.images.length === 1), "a name was read as HTML");
  check((await textOf(page, "#events")).includes("\\u202egnp.exe"), "a sign that turns others around is not written out");
  const wide = await page.evaluate(() => [...document.querySelectorAll("aside, aside *")].filter((one) => one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).overflowX === "visible" && one.clientWidth > 0).map((one) => one.id || one.className || one.tagName));
  check(wide.length === 0, `runs over: ${wide.join(", ")}`);
  await picture(page, "hostile");
  await shut(page);
}

async function aHundredThousandScroll() {
  const world = new FakeWorld().box("floor", [0, 0, -0.1], [60, 60, 0.1], { scene: "hall" });
  for (let i = 0; i < 100000; ++i) world.box(`bin_${i}`, [(i % 316) * 0.3 - 50, Math.floor(i / 316) * 0.3 - 50, 0.1], [0.1, 0.1, 0.1], { scene: "hall" });
  const page = await open(world);
  const rows = () => page.evaluate(() => ({ all: collidedPage.things.rows.length, made: document.querySelectorAll("#things [role=treeitem]").length }));
  const { all, made } = await rows();
  check(all === 100002, `${all} rows`);
  check(made < 80, `${made} rows are made for what is seen of them`);
  await page.evaluate(() => { document.getElementById("things").scrollTop = 1e9; });
  await until("the last one is seen", async () => /bin_99999/.test(await textOf(page, "#things")));
  await page.fill("#search", "bin_9999?");
  await until("the search finds ten", async () => (await rows()).all === 11);
  check((await textOf(page, "#thing-count")).startsWith("10 of"), await textOf(page, "#thing-count"));
  await page.fill("#search", "no such thing");
  await until("nothing is said to be found", async () => /no object has such a name/.test(await textOf(page, "#no-things")));
  await shut(page);
}

async function thingsAreChosenFollowedAndHidden() {
  const world = hall();
  const details = { kind: "sphere", moving: true, scene: "", publisher: "robot", layers: 1, mask: 0xffffffff, group: 0, triangles: 0, stale: false, solid: true, bounds: [[0, 0, 0], [0.8, 0.8, 0.8]], age: 0.0123456789, contacts: [] };
  const page = await open(world, { answers: { object: () => details, owners: () => ({ owners: [{ publisher: "robot", slots: [4, 5] }], left_out: 0 }) } });
  await until("publishers are groups", async () => /publisher robot/.test(await textOf(page, "#things")));
  await page.focus("#things");
  for (const key of ["Home", "ArrowDown", "Enter"]) await page.keyboard.press(key);
  await until("the keyboard chooses", async () => (await textOf(page, "#selected-name")) === "ball_1");
  await until("the server is asked", async () => /12.3 ms/.test(await textOf(page, "#selected-facts")));
  check(/robot/.test(await textOf(page, "#selected-facts")), "who moves it is not said");
  await page.click("#follow");
  const target = () => page.evaluate(() => collidedPage.camera.target[0]);
  const before = await target();
  world.objects[world.slotOf("ball_1")].pose[0] = 2;
  world.move(1);
  await until("the camera follows", async () => Math.abs((await target()) - before - 2) < 1e-5);
  await page.click("#hide");
  const isSeen = () => page.evaluate(() => {
    const { camera, world, picture: { renderer } } = collidedPage;
    const [x, y] = camera.project(world.byName.get("ball_1").position);
    return renderer.pick((x + 1) / 2, (y + 1) / 2)?.slot === world.byName.get("ball_1").slot;
  });
  await until("it is gone", async () => !(await isSeen()));
  await page.click("#show-all");
  await until("it is back", isSeen);
  await shut(page);
}

async function partsAreListed() {
  const world = hall();
  world.sphere("robot", [0, -2, 0.5], 0.3);
  world.objects.at(-1).parts.push([1, 0, 0, 1, 1, 0, 0, 0, 0.5, 0.25, 1], [2, 0, 0, 0, 0, 0, 2, 0.125]);
  const page = await open(world);
  await page.focus("#things");
  for (const key of ["Home", "ArrowDown", "ArrowDown", "ArrowDown", "ArrowRight"]) await page.keyboard.press(key);
  await until("its parts are told", async () => /sphere, radius 300 mmbox 1 m × 500 mm × 2 mcapsule, radius 125 mm, 2 m long/.test(await textOf(page, "#things")));
  for (const key of ["ArrowDown", "ArrowLeft", "ArrowLeft"]) await page.keyboard.press(key);
  await until("they are folded", async () => !/capsule/.test(await textOf(page, "#things")));
  await shut(page);
}

async function coloursTellWhoHasMoved() {
  const world = hall();
  const page = await open(world);
  await page.selectOption("#color", "age");
  const colorOf = (name) => page.evaluate((which) => [...collidedPage.world.tints.subarray(4 * collidedPage.world.byName.get(which).slot)].slice(0, 3).join(), name);
  world.objects[world.slotOf("ball_1")].pose[0] = 0.25;
  world.move(10);
  world.move(10.1);
  await until("what has just moved is warm", async () => (await colorOf("ball_1")) === "213,94,0");
  check((await colorOf("ball_2")) === "86,180,233", `what has never moved is ${await colorOf("ball_2")}`);
  check((await colorOf("floor")) === "120,120,120", "what cannot move has an age");
  world.move(11.5);
  await until("it cools", async () => (await colorOf("ball_1")) === "230,159,0");
  check(/moved within 200 ms.*longer ago.*does not move/.test(await textOf(page, "#color-legend")), await textOf(page, "#color-legend"));
  await shut(page);
}

// ---- asking, time

async function commandsHaveAllDigitsAndTheWay() {
  const hit = { answer: "hit", object: "shelf_1", distance: 12.345678901234567, error: 3e-15, point: [-3, 1.23456789012345, 1.5], normal: [0, 0, 1], point_error: 1e-15 };
  const page = await open(hall(), { answers: { ray: () => hit } });
  await page.focus("#scene");
  await page.keyboard.press("Enter");
  await until("the answer is shown", async () => /shelf_1/.test(await textOf(page, "#answer-text")));
  const text = await textOf(page, "#answer-text");
  check(/12.35 m/.test(text) && !/\d\.\d{6}/.test(text), `not rounded: ${text}`);
  const sent = await page.evaluate(() => collidedPage.asking.lastAnswer);
  const command = await textOf(page, "#answer-command");
  check(command === `collide --domain 7 --namespace hall ray ${sent.origin.join(" ")}  ${sent.direction.join(" ")}`, command);
  await shut(page);
}

/// Each tool asks what was clicked or drawn, shows the answer rounded, its cost, and the command that gives the same.
async function toolsAskWhatIsDrawn() {
  const world = hall().sphere(kHostile[1], [-1.5, -1, 0.5], 0.3).sphere("it's", [-1.5, 1, 0.5], 0.3);
  const hit = (object, more = {}) => ({ object, distance: 0.041234567890123, error: 8.9e-16, point: [0, 0, 0], normal: [0, 0, 1], point_error: 0, ...more });
  const cost = { nodes: 7, exact_tests: 2, compute: 41e-6 };
  const page = await open(world, { answers: {
    sphere: () => ({ answer: "hit", hits: [hit("shelf_1"), hit("floor", { distance: 0 })], left_out: 0, cost, age: 0.0021 }),
    box: () => ({ answer: "miss", hits: [], left_out: 0, cost }),
    near: () => ({ answer: "hit", hits: [hit("ball_1", { point: [1, 0, 0.5] }), hit("shelf_2")], left_out: 0, cost }),
    sweep: () => ({ answer: "hit", hits: [hit("ball_2", { time_low: 0.5, time_high: 0.5000001 })], left_out: 0, cost }),
    pair: () => ({ answer: "miss", distance: 1.25, error: 0, on_a: [0, 0, 0.5], on_b: [1, 0, 0.5] }),
  } });
  const scene = await page.locator("#scene").boundingBox();
  const at = (point) => page.evaluate((where) => {
    const [x, y] = collidedPage.camera.project(where);
    const box = document.getElementById("scene").getBoundingClientRect();
    return [box.left + ((x + 1) / 2) * box.width, box.top + ((1 - y) / 2) * box.height];
  }, point);
  const asked = () => world.asked.filter(({ ask }) => !["owners", "object", "nearest"].includes(ask)).at(-1);
  const answered = async (expected) => until(`the answer says ${expected}`, async () => expected.test(await textOf(page, "#answer-text")));
  const command = () => textOf(page, "#answer-command");
  const near = (value, wanted) => Math.abs(value - wanted) < 0.02;

  await page.selectOption("#tool", "sphere");
  const [from, to] = [await at([0, -2, 0]), await at([0, -2, 0])];
  await page.mouse.click(...from);
  await answered(/2 things touch the sphere of 500 mm.*41\.2 mm.*shelf_1.*touching.*floor/);
  check(near(asked().center[1], -2) && near(asked().center[2], 0) && asked().radius === 0.5, JSON.stringify(asked()));
  check(/41 µs on the server: 7 nodes, 2 exact tests; poses 2.1 ms old/.test(await textOf(page, "#answer-cost")), await textOf(page, "#answer-cost"));
  check((await command()) === `collide --domain 7 --namespace hall sphere ${asked().center.join(" ")} 0.5`, await command());
  check(await page.evaluate(() => collidedPage.picture.marks.asked.pieces.length > 100), "the sphere is not drawn");
  await picture(page, "asked_sphere");
  const before = await page.evaluate(() => collidedPage.camera.yaw);
  await page.mouse.move(...to);
  await page.mouse.down();
  await page.mouse.move(to[0] + 60, to[1], { steps: 4 });
  check(await page.evaluate(() => collidedPage.picture.marks.preview.length > 100), "the sphere is not drawn while it is dragged");
  await page.mouse.up();
  await until("the drag asks", async () => asked().radius !== 0.5);
  check(asked().radius > 0.2 && (await page.evaluate(() => collidedPage.camera.yaw)) === before, `a drag asks ${JSON.stringify(asked())}, or turns`);

  await page.keyboard.press("3");
  await page.mouse.click(...from);
  await answered(/nothing touches the box/);
  check((await command()) === `collide --domain 7 --namespace hall box --center ${asked().center.join(" ")} --size 0.5 0.5 0.5`, await command());

  await page.keyboard.press("4");
  await page.mouse.click(...from);
  await answered(/nearest to .*41\.23 mm.*ball_1/);
  check((await command()) === `collide --domain 7 --namespace hall near ${asked().point.join(" ")} -k 3`, await command());

  await page.keyboard.press("5");
  await page.fill("#tool-size", "0.1");
  await page.mouse.click(...from);
  check(await page.evaluate(() => collidedPage.tools.waiting !== null), "a sweep does not wait for its end");
  await page.mouse.click(...(await at([2, -2, 0.1])));
  await answered(/meets .*ball_2.* after 1.*m .* of 2.* m/);
  check(asked().radius === 0.1 && asked().from[2] > 0.1 && near(asked().to[2], asked().from[2]), JSON.stringify(asked()));
  check((await command()) === `collide --domain 7 --namespace hall sweep sphere 0.1 --from ${asked().from.join(" ")} --to ${asked().to.join(" ")}`, await command());
  await picture(page, "asked_sweep");

  await page.keyboard.press("6");
  await bring(page, "it's");
  await page.mouse.click(...(await at([-1.5, -1, 0.6])));
  await answered(/it's.* and .*gnp.exe.* are 1.25 m apart \(exact\)/);
  check((await command()) === "collide --domain 7 --namespace hall pair 'it'\\''s' $'\\u202egnp.exe'", await command());
  check(/answered after/.test(await textOf(page, "#answer-cost")), "a pair's time is not told");
  await page.keyboard.press("Escape");
  check(await page.evaluate(() => document.getElementById("answer").hidden && !collidedPage.picture.marks.asked), "the answer stays");
  check(scene.width > 0, "there is no picture");
  await shut(page);
}

/// The chosen object's nearest neighbour is asked again and again, named, and joined with it by a line.
async function theNearestIsShown() {
  const world = hall();
  let clearance = 0.25;
  const page = await open(world, { answers: { nearest: ({ name }) => ({ answer: "miss", name, other: "ball_2", clearance, error: 1e-16, on_a: [0.4, 0, 0.5], on_b: [1.1, 0, 0.5], late: false, tested: 3 }) } });
  await bring(page, "ball_1");
  await until("it is told", async () => /nearestball_2clearance250 mm/.test(await textOf(page, "#selected-facts")));
  check(await page.evaluate(() => collidedPage.picture.marks.nearest?.text) === "250 mm", "it has no line");
  clearance = 0.125;
  await until("it is asked again", async () => /125 mm/.test(await textOf(page, "#selected-facts")));
  const asked = () => world.asked.filter(({ ask }) => ask === "nearest").length;
  await page.keyboard.press("p");
  await until("the past has none", () => page.evaluate(() => !collidedPage.picture.marks.nearest));
  const before = asked();
  await new Promise((done) => setTimeout(done, 400));
  check(asked() === before, "it is asked while the past is shown");
  await page.click("#live");
  clearance = -0.01;
  await until("an overlap is told", async () => /10 mm deep/.test(await textOf(page, "#selected-facts")));
  check(await page.evaluate(() => !collidedPage.picture.marks.nearest), "an overlap has a line");
  await shut(page);
}

/// Pausing keeps the picture while the world goes on; going back shows what was; going live shows what is.
async function timeGoesBack() {
  const world = hall();
  const page = await open(world);
  const x = () => page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0]);
  const isAt = (where) => until(`ball_1 is at ${where}`, async () => Math.abs((await x()) - where) < 1e-6);
  const moveTo = async (where) => {
    world.objects[world.slotOf("ball_1")].pose[0] = where;
    world.move(where);
    await isAt(where);
  };
  await moveTo(1);
  world.tell({ type: "events", left_out: 0, events: [world.event("began", "ball_1", "shelf_1")] });
  await until("the event is listed", async () => /ball_1/.test(await textOf(page, "#events")));
  await moveTo(2);
  await page.keyboard.press("p");
  world.objects[world.slotOf("ball_1")].pose[0] = 3;
  world.move(3);
  await until("the page has heard of it", () => page.evaluate(() => collidedPage.timeline.history.frames.at(-1).value.worldTime === 3));
  check(Math.abs((await x()) - 2) < 1e-6, "a page that is paused moves");
  await page.keyboard.press(",");
  await isAt(1);
  await page.keyboard.press(".");
  await isAt(2);
  await page.click("#events button");
  await until("the event's instant is shown", () => page.evaluate(() => collidedPage.chosen === collidedPage.world.byName.get("ball_1").slot));
  await isAt(1);
  await page.click("#live");
  await isAt(3);
  await page.evaluate(() => {
    const { history } = collidedPage.timeline;
    const frame = history.frames.at(-1).value;
    for (let i = 0; i < 4000; ++i) history.add(history.end + 0.01, "poses", frame);
  });
  const kept = await page.evaluate(() => collidedPage.timeline.history.end - collidedPage.timeline.history.begin);
  check(kept <= 31.5, `${kept} s are kept`);
  await shut(page);
}

// ---- panels, on every screen

/// Nothing runs out of its place, events have their depth, and what is over the picture leaves the panels free.
async function fitsEveryScreen() {
  for (const [width, height] of [[360, 740], [700, 900], [1024, 768], [1280, 800], [2560, 1440]]) {
    const world = hall();
    const page = await open(world, { width, height, touch: width < 700, night: width === 1280 });
    world.tell({ type: "events", left_out: 0, events: [world.event("began", "warehouse/north/shelf_17/upper", "fleet/robots/carrier_0042/bumper")] });
    if (width < 700) await page.tap("#tabs [data-panel=panel-events]");
    await until("the event is listed", async () => /12.3 mm/.test(await textOf(page, "#events")));
    const found = await page.evaluate(() => {
      const box = (one) => one.getBoundingClientRect();
      const scene = box(document.getElementById("scene"));
      const panels = [...document.querySelectorAll("aside")].map(box).filter(({ width: wide, height: high }) => wide && high);
      return {
        page: document.documentElement.scrollWidth, screen: innerWidth, scene: [scene.width, scene.height],
        covered: panels.some((one) => one.left < scene.right - 1 && one.right > scene.left + 1 && one.top < scene.bottom - 1 && one.bottom > scene.top + 1),
        depth: (() => {
          const depth = document.querySelector("#events .depth");
          const { left, right } = box(depth);
          return depth.scrollWidth <= depth.clientWidth + 1 && left >= 0 && right <= innerWidth;
        })(),
        cut: [...document.querySelectorAll("#events .pair, #events time")].some((one) => one.scrollWidth > one.clientWidth + 1 && one.clientWidth > 0),
        small: matchMedia("(pointer: coarse)").matches ? [...document.querySelectorAll("button, select, summary")].filter((one) => box(one).height && box(one).height < 44 && box(one).width).map((one) => `${one.id || one.className || one.textContent} ${box(one).height}`) : [],
      };
    });
    const where = `${width}x${height}`;
    check(found.page <= found.screen, `${where}: the page is ${found.page} wide`);
    check(found.scene[0] >= 0.4 * width && found.scene[1] >= 0.4 * height, `${where}: the picture has ${found.scene}`);
    check(!found.covered, `${where}: a panel lies over the picture`);
    check(found.depth, `${where}: the depth is cut off`);
    check(!found.cut, `${where}: an event is cut off`);
    check(found.small.length === 0, `${where}: too small to touch: ${found.small.join(", ")}`);
    const { used, free } = await page.evaluate(() => {
      const { camera, world: { bounds } } = collidedPage;
      collidedPage.fitAll();
      const scene = document.getElementById("scene").getBoundingClientRect();
      const seen = bounds.corners().map((corner) => camera.project(corner));
      const x = seen.map(([part]) => scene.left + ((part + 1) / 2) * scene.width);
      const y = seen.map(([, part]) => scene.top + ((1 - part) / 2) * scene.height);
      const box = (id) => document.getElementById(id).getBoundingClientRect();
      return { used: [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)], free: [scene.left, box("title").bottom, scene.right, box("timeline").top] };
    });
    const isInside = used[0] >= free[0] && used[1] >= free[1] && used[2] <= free[2] && used[3] <= free[3];
    check(isInside, `${where}: the world is seen from ${used}, what is free is ${free}`);
    const fills = Math.max((used[2] - used[0]) / (free[2] - free[0]), (used[3] - used[1]) / (free[3] - free[1]));
    check(fills > 0.8, `${where}: the world fills ${fills} of what is free`);
    await picture(page, `screen_${where}`);
    await shut(page);
  }
}

/// The label of the pointer stays in the picture, whatever its length and wherever the pointer is.
async function labelsStayInThePicture() {
  const world = new FakeWorld().box("x".repeat(200), [0, 0, -0.1], [400, 400, 0.1], { scene: "hall" }).sphere("ball", [0, 0, 1], 0.5);
  const page = await open(world);
  await page.evaluate(() => Object.assign(collidedPage.camera, { distance: 30, pitch: 1.2, isTouched: true }));
  const scene = await page.locator("#scene").boundingBox();
  for (const [x, y] of [[0.99, 0.6], [0.5, 0.7], [0.98, 0.7]]) {
    await page.mouse.move(scene.x + x * scene.width, scene.y + y * scene.height);
    await until(`the label is there at ${x} ${y}`, () => page.evaluate(() => !document.getElementById("label").hidden), 40);
    const label = await page.locator("#label").boundingBox();
    check(label.x >= scene.x && label.x + label.width <= scene.x + scene.width + 1, `at ${x}: the label is from ${label.x} to ${label.x + label.width}, the picture from ${scene.x} to ${scene.x + scene.width}`);
    await page.mouse.move(scene.x + 300, 5);
  }
  await shut(page);
}

/// Text is told apart from its ground as WCAG 2.2 (1.4.3, level AA) asks, by day and by night; choices are kept.
async function textIsLegible() {
  for (const night of [false, true]) {
    const page = await open(hall(), { night });
    const ratios = await page.evaluate(() => {
      const style = getComputedStyle(document.documentElement);
      const luminance = (name) => {
        const text = style.getPropertyValue(name).trim();
        const parts = [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2];
      };
      const ratio = (a, b) => (Math.max(luminance(a), luminance(b)) + 0.05) / (Math.min(luminance(a), luminance(b)) + 0.05);
      return ["--ink", "--quiet", "--accent-text"].flatMap((text) => ["--paper", "--raised"].map((ground) => [text, ground, ratio(text, ground)]));
    });
    for (const [text, ground, ratio] of ratios) check(ratio >= 4.5, `${night ? "night" : "paper"}: ${text} on ${ground} is ${ratio.toFixed(2)}; 4.5 is the least`);
    const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas[tabindex], [role=tree]")].filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim() || one.labels?.length)).map((one) => one.id));
    check(unnamed.length === 0, `without a name: ${unnamed.join(", ")}`);
    if (!night) {
      await page.click("#panel-stages summary");
      await until("that is kept", () => page.evaluate(() => localStorage.getItem("collided panel-stages") === "false"));
      await page.reload();
      await until("it stays folded", () => page.evaluate(() => window.collidedPage && !document.getElementById("panel-stages").open));
    }
    await shut(page);
  }
}

/// Nothing but these three files is needed, and they are small.
function isSmall() {
  const bytes = Object.values(files).reduce((sum, [, text]) => sum + Buffer.byteLength(text), 0);
  check(bytes < 300e3, `the page has ${bytes} bytes`);
  console.log(`size: ${(bytes / 1e3).toFixed(0)} kB`);
}

const tests = [
  isSmall, restsAtFullResolution, coincidingFacesDoNotFlicker, smallRoundThingsAreTheSame, tenThousandMove, contactsAreClustered, fencesAreLitWhileEntered, overlapsThatAreNoContactsAreSaidSo, hostileNamesAreOnlyNames, aHundredThousandScroll,
  thingsAreChosenFollowedAndHidden, partsAreListed, coloursTellWhoHasMoved, commandsHaveAllDigitsAndTheWay, toolsAskWhatIsDrawn, theNearestIsShown, timeGoesBack, fitsEveryScreen, labelsStayInThePicture, textIsLegible,
];
try {
  browser = await launch();
  for (const test of tests.filter(({ name }) => !words.only || name === words.only)) {
    const begun = Date.now();
    try {
      await test();
      check(wrong.length === 0, `the page's errors: ${wrong.splice(0).join("; ")}`);
      console.log(`${test.name}: as it should be, ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    } catch (failed) {
      console.error(`${test.name}: ${failed.message}${wrong.length ? ` (the page's errors: ${wrong.splice(0).join("; ")})` : ""}`);
      process.exitCode = 1;
      for (const context of browser.contexts()) await context.close();
    }
  }
} finally {
  await browser?.close();
}
