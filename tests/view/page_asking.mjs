// Tests of the page: asking and time.
import { check, picture, until } from "./chromium.mjs";
import { bring, hall, kHostile, open, shut, textOf } from "./page_fixture.mjs";

export async function commandsHaveAllDigitsAndTheWay() {
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
export async function toolsAskWhatIsDrawn() {
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
  // Half of two metres, from pixel to pixel.
  await answered(/meets .*ball_2.* after (1|9)[\d.]* m?m .* of (2|1\.9)[\d.]* m/);
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
export async function theNearestIsShown() {
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

/// What other clients ask is asked for only while that is wanted, drawn faintly, and fades.
export async function whatOthersAskIsDrawn() {
  const world = hall();
  const questions = [
    { kind: "ray", origin: [-3, -2, 2], direction: [1, 0.5, -0.4], answer: "hit", at: [0, -0.5, 0.8], object: "ball_1" },
    { kind: "ray", origin: [3, -2, 2], direction: [0, 0, 1], answer: "miss" },
    { kind: "sphere", center: [1.5, -1.5, 0.6], radius: 0.6, answer: "miss" },
    { kind: "box", center: [-1.5, -2, 0.5], half: [0.6, 0.3, 0.5], orientation: [0.924, 0, 0, 0.383], answer: "hit", at: [-1.5, -2, 0], object: "floor" },
    { kind: "near", point: [2.5, 2, 1.5], answer: "hit", at: [3, 1.3, 1.5], object: "shelf_2" },
    { kind: "inside", point: [0, 2, 1], answer: "miss" },
    { kind: "ray", origin: [null, 0, 0], direction: [0, 0, 0], answer: "invalid" },
  ];
  let isRefused = false;
  const sampled = ({ since, id }) => {
    if (isRefused) world.tell({ type: "refused", id, why: "the keys give no right to change the world" });
    return isRefused ? null : { since: since + questions.length, questions: questions.map((one) => ({ ...one, ago_ns: 1e8 })) };
  };
  const page = await open(world, { answers: { sampled } });
  const asked = () => world.asked.filter(({ ask }) => ask === "sampled").length;
  const drawn = () => page.evaluate(() => collidedPage.picture.marks.others.length);
  await new Promise((done) => setTimeout(done, 500));
  check(asked() === 0 && (await drawn()) === 0, "it is asked though nobody wants it");
  await page.evaluate(() => document.getElementById("others").click());
  await until("they are drawn", async () => (await drawn()) >= questions.length && asked() >= 2);
  check(world.asked.filter(({ ask }) => ask === "sampled")[1].since === questions.length, "all are asked for again");
  await picture(page, "others_paper");
  await page.evaluate(() => document.getElementById("theme").click());
  await until("they are drawn by night", async () => (await drawn()) > 0);
  await picture(page, "others_night");
  await page.evaluate(() => document.getElementById("others").click());
  await until("they are gone", async () => (await drawn()) === 0);
  const before = asked();
  isRefused = true;
  await page.evaluate(() => document.getElementById("others").click());
  await until("a refusal is told", async () => /no right/.test(await textOf(page, "#others-note")));
  check(await page.evaluate(() => !document.getElementById("others").checked), "the switch stays on");
  check(asked() === before + 1, "it is asked again and again");
  await shut(page);
}

/// While the past is shown, publishers do not seem to fall silent, a click chooses what is seen, and questions say why they wait.
export async function thePastIsNotAskedAbout() {
  const world = hall();
  const page = await open(world);
  world.tell(world.status({ publishers: [{ name: "robot", messages: 1, silent: 1.5, lost: false }] }));
  await until("the publisher is listed", async () => /robot/.test(await textOf(page, "#publishers")));
  await page.keyboard.press("p");
  const clicked = async () => {
    const [x, y] = await page.evaluate(() => {
      const [across, up] = collidedPage.camera.project(collidedPage.world.byName.get("ball_1").position);
      const { left, top, width, height } = document.getElementById("scene").getBoundingClientRect();
      return [left + ((across + 1) / 2) * width, top + ((1 - up) / 2) * height];
    });
    await page.mouse.move(x, y);
    await until("it is seen there", async () => /ball_1/.test(await textOf(page, "#label")));
    await page.mouse.click(x, y);
  };
  const before = world.asked.filter(({ ask }) => ask === "ray").length;
  await clicked();
  await until("the click chooses", async () => (await textOf(page, "#selected-name")) === "ball_1");
  check(await page.evaluate(() => document.getElementById("answer").hidden), `it also says: ${await textOf(page, "#answer-text")}`);
  await page.selectOption("#tool", "near");
  await clicked();
  await until("the reason is said", async () => /the past is shown.*press live/.test(await textOf(page, "#answer-text")));
  world.tell({ type: "silent", seconds: 83 });
  await new Promise((done) => setTimeout(done, 1500));
  check(!(await page.evaluate(() => document.querySelector("#publishers .wrong"))), `the publisher seems silent: ${await textOf(page, "#publishers")}`);
  check(/^ready/.test(await textOf(page, "#state")), `the past is said to be: ${await textOf(page, "#state")}`);
  check(world.asked.filter(({ ask }) => ask === "ray" || ask === "near").length === before, "the server was asked");
  await page.click("#live");
  await until("now it is silent", () => page.evaluate(() => Boolean(document.querySelector("#publishers .wrong"))));
  world.tell(world.status({ step_lasting: 3.25 }));
  await until("a long step is said", async () => /^ready, step has lasted 3\.\d+ s ·/.test(await textOf(page, "#state")));
  await page.selectOption("#tool", "ray");
  await shut(page);
}

/// What came while the page was busy is still before it: it does not take its viewer for gone, however long that was.
export async function aBusyPageKeepsItsViewer() {
  const world = hall();
  const page = await open(world);
  await page.evaluate(() => {
    const end = performance.now() + 5500;
    while (performance.now() < end);
    collidedPage.source.lookForSilence();  // it may come before what has arrived
  });
  world.tell(world.status({ scenes: ["after"] }));
  await until("it hears its viewer", async () => /after/.test(await textOf(page, "#scenes")));
  check(world.connections === 1, `it has connected ${world.connections} times`);
  await shut(page);
}

/// Pausing keeps the picture while the world goes on; going back shows what was; going live shows what is.
export async function timeGoesBack() {
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
