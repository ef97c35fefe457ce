// The page in Firefox, with graphics by software, and without any.
//   node page_firefox.mjs --collided PATH --collide PATH --modules DIR [--pictures DIR]
import { Firefox, startDisplay } from "./firefox.mjs";
import { collide, runAndStop, start, startServer, startViewer } from "./processes.mjs";
import { check, until, words } from "./waiting.mjs";

const kBalls = 16;

/// What the server has, by the command line.
function counts() {
  const said = collide("status", "--json");
  check(said.status === 0, said.stderr);
  const { objects, moving } = JSON.parse(said.stdout);
  return { objects, moving };
}
const countsOfPage = (page) => page.evaluate(() => {
  const objects = [...(window.collidedPage?.world.objects.values() ?? [])];
  return { objects: objects.length, moving: objects.filter(({ moving }) => moving).length };
});

async function hasAllObjects(page) {
  const there = counts();
  check(there.moving === kBalls, `${there.moving} objects move`);
  await until("all objects are there", async () => JSON.stringify(await countsOfPage(page)) === JSON.stringify(there), 60);
  await until("the panels say so", () => page.evaluate(({ objects, moving }) => document.getElementById("scenes").textContent.endsWith(`${objects} objects, ${moving} moving`), there));
  await until("events are listed", () => page.evaluate(() => document.querySelectorAll("#events li").length > 0));
  return there;
}

/// A place of the picture where something that stands still is seen, in the page's pixels.
const standing = (page) => page.evaluate(() => {
  const { picture: { renderer }, world } = collidedPage;
  const scene = document.getElementById("scene").getBoundingClientRect();
  const slotAt = (x, y) => renderer.pick(x, y)?.slot;
  for (let x = 0.2; x < 0.7; x += 0.05) {
    for (let y = 0.7; y > 0.3; y -= 0.05) {
      const object = world.objects.get(slotAt(x, y));
      // No edge: what is seen beside it is the same.
      const isAlone = object && [[0.02, 0], [-0.02, 0], [0, 0.02], [0, -0.02]].every(([dx, dy]) => slotAt(x + dx, y + dy) === object.slot);
      if (isAlone && !object.moving) return { x: scene.left + x * scene.width, y: scene.top + (1 - y) * scene.height, name: object.name };
    }
  }
  return null;
});

/// A click asks the ray that the command line gives the same answer to.
async function clickIsAnswered(page) {
  const place = await standing(page);
  check(place, "nothing that stands still is in the picture");
  await page.click(place.x, place.y);
  const answer = await until("the click is answered", () => page.evaluate(() => collidedPage.asking.lastAnswer));
  check(answer.answer === "hit", `the click is answered ${JSON.stringify(answer)}`);
  const shown = await page.evaluate(() => (document.getElementById("answer").hidden ? "" : document.getElementById("answer-text").textContent));
  check(shown.includes(answer.object), `the answer is shown as '${shown}'`);
  if (answer.object !== place.name) return console.log(`  something came before ${place.name}: ${answer.object}`);
  const said = collide("ray", ...answer.origin.map(String), ...answer.direction.map(String), "--json");
  const theirs = JSON.parse(said.stdout);
  for (const member of ["object", "distance", "error", "point", "normal"]) check(JSON.stringify(answer[member]) === JSON.stringify(theirs[member]), `${member} is ${answer[member]}, the command line says ${theirs[member]}`);
}

async function withGraphics(url) {
  const display = await startDisplay();
  const page = await Firefox.start(display);
  await page.resize(1280, 800);
  await page.open(`${url}/#theme=paper`);
  await until("a picture is drawn", () => page.evaluate(() => Boolean(window.collidedPage?.picture.renderer?.whole)), 60);
  const { objects, moving } = await hasAllObjects(page);
  const positions = () => page.evaluate(() => collidedPage.world.movers.map(({ position }) => position.join()).join(" "));
  const before = await positions();
  await until("they move", async () => (await positions()) !== before);
  await clickIsAnswered(page);
  await page.picture("firefox_paper");
  await page.resize(360, 740);
  await until("the page fits a phone", () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.getElementById("scene").clientWidth === innerWidth));
  await page.picture("firefox_phone");
  check(page.errors.length === 0, `the page's errors: ${page.errors.join("; ")}`);
  console.log(`with graphics: ${objects} objects, ${moving} move; a click is answered; ${await page.evaluate(() => collidedPage.picture.renderer.gl.getParameter(collidedPage.picture.renderer.gl.RENDERER))}`);
  await page.stop();
  display.stop();
}

async function withoutGraphics(url) {
  const page = await Firefox.start(null);
  await page.resize(1000, 640);
  await page.open(url);
  await until("the drawing is shown", () => page.evaluate(() => document.getElementById("drawing").naturalWidth > 0), 60);
  await hasAllObjects(page);
  await page.picture("firefox_drawing");
  check(page.errors.length === 0, `the page's errors: ${page.errors.join("; ")}`);
  console.log("without graphics: the drawing and the panels");
  await page.stop();
}

await runAndStop("firefox", async () => {
  await startServer();
  start(words.collide, ["publish", "--spheres", String(kBalls), "--side", "3", "--size", "0.18", "--speed", "1.5", "--round", "--bounce", "--rate", "30", "--as", "homework", "--name", "ball"]);
  const { url } = await startViewer();
  await until("the balls are there", () => counts().moving === kBalls);
  await withGraphics(url);
  await withoutGraphics(url);
});
