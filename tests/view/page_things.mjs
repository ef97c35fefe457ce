// Tests of the page: objects, their tree and colours.
import { check, picture, until } from "./chromium.mjs";
import { FakeWorld } from "./fake_viewer.mjs";
import { bring, hall, kHostile, open, shut, textOf } from "./page_fixture.mjs";

export async function hostileNamesAreOnlyNames() {
  const world = hall();
  kHostile.forEach((name, i) => world.sphere(name, [i - 2, -2, 0.5], 0.3));
  world.box("hall/shelf/upper/with/a/name/as/long/as/this", [-3, -1, 0.75], [0.5, 0.3, 0.75], { scene: "hall" });
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
  const broken = await page.evaluate(() => [...document.querySelectorAll("#things [role=treeitem]")].filter((row) => row.scrollHeight > row.clientHeight + 2).map((row) => row.textContent));
  check(broken.length === 0, `more than one line in the tree: ${broken.join("; ")}`);
  const tall = await page.evaluate(() => [...document.querySelectorAll("#events li, #publishers tr")].map((row) => row.offsetHeight).filter((high) => high > 90));
  check(tall.length === 0, `a row of a list is ${tall.join(", ")} pixels high`);
  await picture(page, "hostile");
  await shut(page);
}

export async function aHundredThousandScroll() {
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

export async function thingsAreChosenFollowedAndHidden() {
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

export async function partsAreListed() {
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

/// Parts of one file are each seen, named and gone to by themselves; what one of them encloses is not what the file does.
export async function partsOfAFileHaveTheirOwnPlaces() {
  const houses = [0, 1, 2, 3].map((i) => [`house_${i}`, [40 * i - 60, 30 * (i % 2), 4], [5, 5, 4]]);
  const world = new FakeWorld().file("city", houses).file("desk", [["table", [0, -40, 5], [10, 10, 5]], ["lamp", [0, -40, 14], [0.5, 0.5, 0.5]]]);
  world.sphere("ball", [0, -40, 11], 1);
  const page = await open(world);
  await bring(page, "house_3");
  await page.click("#frame");
  const { target, distance } = await page.evaluate(() => collidedPage.camera);
  check(Math.hypot(target[0] - 60, target[1] - 30, target[2] - 4) < 0.01 && distance < 100, `"go to" looks at ${target} from ${distance} m`);
  await page.evaluate(() => document.getElementById("fit").click());
  await page.click("#labels");
  await until("each has its name in the picture", () => page.evaluate(() => ["house_0", "house_1", "house_2", "house_3"].every((name) => collidedPage.picture.labels.placed.some(([, , , , text]) => text.includes(name)))));
  await page.evaluate(() => collidedPage.world.openShells());
  const opened = await page.evaluate(() => [...collidedPage.world.objects.values()].filter(({ slot }) => collidedPage.world.hasState(slot, 3 << 12)).map(({ name }) => name));
  check(opened.length === 0, `drawn open, though nothing is in it: ${opened}`);
  await shut(page);
}

/// What is pressed on a panel is what the click is about, though the panel would have changed meanwhile.
export async function clicksOnPanelsCount() {
  const world = hall();
  const page = await open(world);
  const press = async (selector) => {
    const middle = await until(`${selector} is there`, () => page.evaluate((which) => {
      const { left, right, top, bottom } = document.querySelector(which)?.getBoundingClientRect() ?? {};
      return left < right && [(left + right) / 2, (top + bottom) / 2];
    }, selector));
    await page.mouse.move(...middle);
    await page.mouse.down();
    await new Promise((done) => setTimeout(done, 500));
    await page.mouse.up();
  };
  await press("#things [role=treeitem]");
  check((await page.evaluate(() => collidedPage.things.folded.size)) === 1, "the first click on the row of the cursor is lost");
  await bring(page, "ball_1");
  let depth = 0.01;
  const deeper = () => world.tell({ type: "events", left_out: 0, events: [world.event("persisted", "ball_1", "floor", { depth: (depth += 1e-4) })] });
  deeper();
  await until("the contact is listed", async () => /floor/.test(await textOf(page, "#selected-contacts")));
  const changes = setInterval(deeper, 50);
  await press("#selected-contacts button");
  clearInterval(changes);
  check((await textOf(page, "#selected-name")) === "floor", "a click on a contact whose depth changes is lost");
  await until("the panels go on", async () => /no contact with anything that moves|mm/.test(await textOf(page, "#selected-contacts")));
  await shut(page);
}

/// The server compares nothing that stands still with what stands still: their overlaps are not said to be none.
export async function whatStandsStillIsNotSaidToTouchNothing() {
  const page = await open(hall());
  for (const [name, expected] of [["floor", "no contact with anything that moves"], ["ball_1", "no contact"]]) {
    await bring(page, name);
    await until("its contacts are told", async () => (await textOf(page, "#selected-contacts")) === expected);
  }
  await shut(page);
}

export async function coloursTellWhoHasMoved() {
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
