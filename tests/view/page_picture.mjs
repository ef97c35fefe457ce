// Tests of the page: the picture.
import { loadavg } from "node:os";
import { check, picture, until } from "./chromium.mjs";
import { FakeWorld } from "./fake_viewer.mjs";
import { bring, hall, kHostile, open, shut, textOf } from "./page_fixture.mjs";

/// When nothing moves the picture has every pixel of the screen, whatever it had while things moved.
export async function restsAtFullResolution() {
  const page = await open(hall());
  await page.evaluate(() => {
    collidedPage.picture.motionSharpness = 0.4;
    collidedPage.changed();
  });
  const { canvas, screen, text } = await until("the picture is sharp", () => page.evaluate(() => {
    const { clientWidth: screen, width: canvas } = document.getElementById("scene");
    return collidedPage.picture.renderer.sharpness >= 1 && { canvas, screen, text: collidedPage.picture.qualityText() };
  }));
  check(canvas >= screen, `the picture has ${canvas} columns of pixels, the screen ${screen}`);
  check(/full resolution/.test(text), `it is not said: ${text}`);
  const coarser = await page.evaluate(() => {
    collidedPage.picture.renderer.sharpness = 0.4;  // until the next picture
    return collidedPage.picture.qualityText();
  });
  check(/40 % of the pixels/.test(coarser), `a coarser picture is not said to be one: ${coarser}`);
  await shut(page);
}

/// Another theme is drawn everywhere, also where nothing moves.
export async function nightFallsEverywhere() {
  const world = hall();
  const page = await open(world);
  let x = 0;
  const moveOn = async () => {
    const at = (x += 0.1);
    world.objects[world.slotOf("ball_1")].pose[0] = at;
    world.move(at);
    await until("it is drawn", () => page.evaluate((place) => Math.abs(collidedPage.world.byName.get("ball_1").position[0] - place) < 1e-6 && !collidedPage.picture.isDirty, at));
  };
  for (let i = 0; i < 3; ++i) await moveOn();
  await page.keyboard.press("t");
  for (let i = 0; i < 3; ++i) await moveOn();
  const corner = await page.evaluate(() => {
    const { gl } = collidedPage.picture.renderer;
    const color = new Uint8Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(3, 3, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, color);
    return [...color];
  });
  check(corner[0] < 80 && corner[1] < 80, `the corner is still ${corner}`);
  await shut(page);
}

/// Of two floors with the same upper side the smaller one is seen, wherever one looks.
export async function coincidingFacesDoNotFlicker() {
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
    for (const name of ["roundPoint", "roundBox", "ballPoint", "boxPoint", "box"]) renderer.programs[name] ||= renderer.begun(...renderer.sources[name]);
    const isReady = renderer.prepare() && ["roundPoint", "roundBox", "ballPoint", "boxPoint", "box"].every((name) => renderer.programs[name].places || renderer.finish(renderer.programs[name]));
    if (!isReady) return null;
    renderer.draw(camera, { ...picture.depths(world, camera), anchor: world.anchor, ground: 0, grid: 1, stillVersion: mostPoint, region: null });
    const [width, height] = renderer.seenSize;
    const numbers = new Uint32Array(4 * width * height);
    const { gl } = renderer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.whole.buffer);
    gl.readPixels(0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, numbers);
    return numbers.filter((_, i) => i % 4 === 0);
  };
  const small = () => ["stillSolids", "movingSolids"].reduce((sum, of) => sum + ["boxes", "balls", "round"].reduce((small, kind) => small + renderer[of][kind].small, 0), 0);
  const points = slots(400);
  const pointCount = small();
  const boxes = points && slots(0);
  if (!boxes) return null;
  return { pointCount, boxCount: small(), differ: points.reduce((sum, slot, i) => sum + (slot !== boxes[i] ? 1 : 0), 0), covered: boxes.reduce((sum, slot) => sum + (slot > 1 ? 1 : 0), 0) };
});

/// Boxes that move and are small are points too; they cover what their triangles would, but for the rounding of corners.
export async function smallBoxesAreTheSame() {
  const world = new FakeWorld().box("floor", [0, 0, -0.1], [9, 9, 0.1], { scene: "hall" });
  const turns = [[1, 0, 0, 0], [0.8, 0.6, 0, 0], [0.5, 0.5, 0.5, 0.5], [0.8, 0, 0.36, 0.48]];
  for (let i = 0; i < 100; ++i) world.add(`thing_${i}`, [1, 0, 0, 0, ...turns[i % 4], 0.4, 0.2, 0.3], { moving: true, at: [(i % 10) * 1.8 - 8, Math.floor(i / 10) * 1.8 - 8, 0.6 + 0.003 * i] });
  const page = await open(world, { width: 720, height: 480 });
  const { pointCount, boxCount, differ, covered } = await until("the shaders are there", () => pointsAgainstBoxes(page), 60);
  check(pointCount === 100 && boxCount === 0, `${pointCount} points, then ${boxCount}`);
  check(covered > 1000 && differ <= 0.01 * covered, `${differ} of ${covered} pixels show something else`);
  await shut(page);
}

/// What is round and small is drawn as points; it covers the same pixels as what is cast inside boxes.
export async function smallRoundThingsAreTheSame() {
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
export async function tenThousandMove() {
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
    while (picture.frames.length < 10 && performance.now() - begun < 300000) await new Promise(requestAnimationFrame);
    clearInterval(feeder);
    return { pictures: picture.frames.length, seconds: (performance.now() - begun) / 1000, small: picture.renderer.movingSolids.balls.small };
  }, count);
  check(small === count, `${small} of ${count} are points`);
  check(pictures >= 10, `${pictures} pictures in ${seconds} s`);
  console.log(`crowd: ${count} movers, ${(pictures / seconds).toFixed(1)} pictures a second, ${loadavg()[0].toFixed(1)} programs at work`);
  await shut(page);
}

/// Many contacts in one place are one mark with their number; what is hidden has none; a touch is called one.
export async function contactsAreClustered() {
  const world = hall();
  const page = await open(world);
  const events = [0, 1, 2, 3, 4].map((i) => world.event("began", "ball_1", i ? `shelf_${1 + (i % 2)}` : "floor", { point: [0.002 * i, 0, 0.1] }));
  world.tell({ type: "events", left_out: 0, events: [...events.slice(0, 3), world.event("began", "ball_2", "shelf_2", { point: [1.5, 0, 0.1], depth: 0 })] });
  await until("the number stands at the mark", () => page.evaluate(() => collidedPage.picture.labels.placed.some(([, , , , text]) => text === "3")));
  const marks = await page.evaluate(() => collidedPage.picture.marks.count);
  check(marks < 12, `${marks} marks for two places`);
  await page.evaluate(() => collidedPage.things.hide([collidedPage.world.byName.get("ball_1")], true));
  await until("what is hidden has no marks", () => page.evaluate(() => collidedPage.picture.labels.placed.every(([, , , , text]) => text !== "3")));
  await until("the touch is told", async () => /touching/.test(await textOf(page, "#events")));
  check(!/ 0 deep|0 m deep/.test(await textOf(page, "body")), "a touch is told as 0 deep");
  await shut(page);
}

/// A mark's number is that of the contacts that hold; those that have just ended only flash.
export async function endedContactsAreNotCounted() {
  const world = hall();
  const page = await open(world);
  const others = ["floor", "site", "shelf_1", "shelf_2", "ball_2"];
  const events = (what) => others.map((other, i) => world.event(what, "ball_1", other, { point: [0.002 * i, 0, 0.1] }));
  world.tell({ type: "events", left_out: 0, events: [...events("began"), ...events("ended").slice(0, 3)] });
  await until("a number stands at the mark", () => page.evaluate(() => collidedPage.picture.labels.placed.length > 0));
  const texts = await page.evaluate(() => collidedPage.picture.labels.placed.map(([, , , , text]) => text).join());
  check(texts === "2", `2 of 5 contacts hold, and ${texts} is shown`);
  await shut(page);
}

/// Where round shapes of two objects coincide, as at the joints of an arm, one is seen, not now this one and now that.
export async function equalRoundThingsDoNotSpeckle() {
  const world = new FakeWorld().box("floor", [0, 0, -0.1], [6, 4, 0.1], { scene: "hall" });
  for (const [name, kind, moving, y] of [["arm", 2, true, -2], ["still_arm", 2, false, -1], ["pipe", 3, true, 0.5], ["still_pipe", 3, false, 1.5]]) {
    let from = [-3, y, 0.4];
    for (let i = 0; i < 5; ++i) {
      const to = kind === 3 ? [from[0] + 1, from[1] + 0.3, from[2] + 0.2] : [from[0] + 0.8, from[1] + 0.5 * Math.sin(i), from[2] + 0.4 * Math.cos(i)];
      world.add(`${name}_${i}`, [kind, ...from, ...to, 0.2], { moving });
      // Pipes are half in each other.
      from = kind === 3 ? [0, 1, 2].map((axis) => (from[axis] + to[axis]) / 2) : to;
    }
  }
  const page = await open(world);
  const speckles = await until("it is drawn", () => page.evaluate(() => {
    const { renderer, isDirty } = collidedPage.picture;
    if (isDirty || !renderer.programs.roundBox?.places) return null;
    const [width, height] = renderer.seenSize;
    const numbers = new Uint32Array(4 * width * height);
    const { gl } = renderer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.whole.buffer);
    gl.readPixels(0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, numbers);
    const slots = numbers.filter((_, i) => i % 4 === 0);
    const names = {};
    for (let i = 1; i + 1 < slots.length; ++i) {
      if (!slots[i] || !slots[i - 1] || slots[i] === slots[i - 1] || slots[i - 1] !== slots[i + 1]) continue;
      const name = collidedPage.world.objects.get(slots[i] - 1).name.slice(0, -2);
      names[name] = (names[name] || 0) + 1;
    }
    return names;
  }));
  // Where an outline is as thin as a pixel there may be a few.
  for (const [name, count] of Object.entries(speckles)) check(count < 6, `${count} pixels of ${name} show another object than those beside them`);
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
const region = (name, lines, more = {}) => ({ name, form: "region", holds: [], lines, ...more });
const held = (object, more = {}) => ({ object, in_doubt: false, since_ns: 0, ...more });

/// Standing questions are outlines that are lit and listed first while they hold something, and go where their carrier goes; going
/// back in time shows who was in then.
export async function standingQuestionsAreLitWhileTheyHoldSomething() {
  const world = hall();
  const page = await open(world);
  const accents = () => page.evaluate(() => {
    const { data, count } = collidedPage.picture.marks;
    const of = (accent) => Array.from({ length: count }, (_, i) => data[10 * i + 9]).filter((one) => one === accent).length;
    return [of(0), of(1)];
  });
  check(await page.evaluate(() => document.getElementById("panel-standing").hidden), "standing questions are listed though there are none");
  const dock = boxLines([1, -1, 0], [4, 2, 1.6]);
  const all = (holds) => [
    region("gate", boxLines([-4, -2, 0], [-2, -1, 1])), region("dock", dock, { holds }),
    region("close", circles(1.2), { form: "bands", about: "ball_1", band: 0.8 }), region("nobody's", circles(1), { to: "not there" }), region(kHostile[0], circles(0.2)),
  ];
  world.tell({ type: "standing", standing: all([]) });
  await until("they are drawn", async () => (await accents())[0] === 24 + 2 * 96);
  check((await accents())[1] === 0, "an empty one is lit");
  const before = await page.evaluate(() => performance.now() / 1000);
  world.tell({ type: "standing", standing: all([held("ball_2")]) });
  await until("the entered one is lit", async () => (await accents()).join() === `${12 + 2 * 96},12`);
  await page.evaluate((t) => {
    collidedPage.timeline.pause();
    collidedPage.timeline.goTo(t);
  }, before);
  await until("it was empty then", async () => (await accents())[1] === 0);
  await page.evaluate(() => collidedPage.timeline.live());
  await until("and is entered now", async () => (await accents())[1] === 12);
  await until("it is listed first", async () => /^dockball_2/.test(await textOf(page, "#standing")));
  check(/5, 1 entered/.test((await textOf(page, "#standing-count")).replace(/\u2009/g, "")), "the count is not told");
  check((await page.evaluate(() => document.querySelector("#standing").innerHTML)).includes("&lt;img"), "a name is read as HTML");
  await picture(page, "standing_held");
  world.objects.find(({ name }) => name === "ball_1").pose[0] = -1;
  world.move(2);
  await until("the band goes along", () => page.evaluate(() => {
    const { data, count } = collidedPage.picture.marks;
    const { anchor } = collidedPage.world;
    let least = Infinity;
    for (let i = 0; i < count; ++i) if (data[10 * i + 8] < 0.35) least = Math.min(least, data[10 * i] + anchor[0]);
    return Math.abs(least - (-1 - 1.2)) < 1e-3;
  }));
  await page.click("#standing .link");
  check(await page.evaluate(() => Math.abs(collidedPage.camera.target[0] - 2.5) < 1e-6), "a click does not go to it");
  world.tell({ type: "standing", standing: all([]) });
  await until("it is empty again", async () => (await accents())[1] === 0);
  await picture(page, "standing_empty");
  world.tell({ type: "standing", standing: [region("escape", [[0, 0, 0, 1.5, 0, 0]], { form: "nearest", to: "ball_1", distance: 1.5, holds: [held("ball_2", { in_doubt: true })] })] });
  await until("what is nearest has its distance", async () => /^escape 1\.5 m from ball_1perhaps ball_2/.test(await textOf(page, "#standing")));
  world.tell({ type: "standing", standing: [] });
  await until("none is left", () => page.evaluate(() => document.getElementById("panel-standing").hidden));
  await shut(page);
}

/// What is under the pointer is compared with what was chosen; an overlap of two that never meet is no contact.
export async function overlapsThatAreNoContactsAreSaidSo() {
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
