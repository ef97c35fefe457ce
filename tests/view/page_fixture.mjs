// A page in the browser with a viewer made here, and what the tests of the page share.
import { launch, until, words } from "./chromium.mjs";
import { FakeWorld, kAddress, pageFiles } from "./fake_viewer.mjs";

export const files = pageFiles(words.source);
export const kHostile = ["<img src=x onerror=\"window.isBroken=1\">", "\u202egnp.exe", "مرحبا بالعالم", "x".repeat(255)];

export function hall() {
  return new FakeWorld()
    .box("floor", [0, 0, -0.1], [6, 4, 0.1], { scene: "hall" })
    .box("site", [0, 0, -0.1], [8, 5, 0.1], { scene: "hall" })
    .box("shelf_1", [-3, 1, 0.75], [0.5, 0.3, 0.75], { scene: "hall" })
    .box("shelf_2", [3, 1, 0.75], [0.5, 0.3, 0.75], { scene: "hall" })
    .sphere("ball_1", [0, 0, 0.5], 0.4)
    .sphere("ball_2", [1.5, 0, 0.5], 0.4);
}

let browser;
export const startBrowser = async () => { browser = await launch(); };
export const stopBrowser = () => browser?.close();
export const closeAll = () => Promise.all(browser.contexts().map((context) => context.close()));

export const wrong = [];
/// Takes back errors that a test has caused.
export const forgive = (expected) => wrong.splice(0, wrong.length, ...wrong.filter((text) => !expected.test(text)));
export async function open(world, { width = 1280, height = 800, touch = false, night = false, answers = {}, path = "" } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, hasTouch: touch, isMobile: touch, deviceScaleFactor: touch ? 2 : 1, colorScheme: night ? "dark" : "light" });
  context.setDefaultTimeout(120e3);
  const page = await context.newPage();
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("console", (message) => { if (message.type() === "error") wrong.push(message.text()); });
  page.on("request", (request) => { if (!request.url().startsWith(kAddress) && !request.url().startsWith("data:")) wrong.push(`asks for ${request.url()}`); });
  await world.serve(page, files, answers);
  await page.goto(kAddress + path, { waitUntil: "commit", timeout: 120e3 });
  await until("the objects are there", () => page.evaluate((count) => window.collidedPage?.world.objects.size === count, world.objects.length), 120);
  // An earlier picture may be one of a part of them: a click in it would hit nothing.
  await until("a picture of them is drawn", () => page.evaluate(async () => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return Boolean(collidedPage.picture.renderer.whole);
  }));
  return page;
}
export const shut = (page) => page.context().close();
export const textOf = (page, selector) => page.evaluate((which) => document.querySelector(which).textContent, selector);
export const bring = (page, name) => page.evaluate((which) => collidedPage.choose(collidedPage.world.byName.get(which).slot), name);
