// Tests of the page: runs, saved ones and those that the viewer makes of recordings. browser.mjs opens real recordings.
import { deflateSync } from "node:zlib";
import { check, until } from "./chromium.mjs";
import { files, forgive, hall, open, shut, textOf } from "./page_fixture.mjs";

const packed = (bytes) => deflateSync(bytes).toString("base64");

/// A run of 2 s in which ball_1 goes 2 m along x, as client/view/run_writer.hpp writes it.
function runOf(world, notes = []) {
  const messages = [{ t: 0, kind: "objects", data: packed(JSON.stringify(world.table())) }];
  for (let i = 0; i <= 40; ++i) {
    world.objects[world.slotOf("ball_1")].pose[0] = i / 20;
    messages.push({ t: i / 20, kind: "poses", data: packed(world.poses(i / 20)) });
  }
  return { begin: 0, end: 2, notes, messages, surfaces: {} };
}

/// Opens a page with a run in it, as `collide view --save` writes it.
async function openSaved(world) {
  const run = runOf(world);
  run.messages.unshift({ t: 0, kind: "text", data: JSON.stringify({ type: "hello", version: "x", up: "z", connection: "" }) });
  files["/saved"] = ["text/html", files["/"][1].replace(`<script src="view.js">`, `<script type="application/json" id="run">${JSON.stringify(run)}</script>\n<script src="view.js">`)];
  return open(world, { path: "saved" });
}

/// A saved page plays without a click, once, to its end.
export async function savedRunsPlayByThemselves() {
  const page = await openSaved(hall());
  const at = () => page.evaluate(() => collidedPage.timeline.at);
  await until("it comes to its end", async () => (await at()) === 2);
  check(await page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0] === 2 && !collidedPage.timeline.isPlaying), "its end is not shown, or it goes on");
  await page.click("#play");
  await until("it plays again", async () => (await at()) > 0 && (await at()) < 1.5);
  await shut(page);
}

/// Drops bytes on the page as a file; of a size, if that is given, which the file only claims to have.
const drop = (page, name, bytes, size) => page.evaluate(([called, numbers, claimed]) => {
  const file = new File([new Uint8Array(numbers)], called);
  if (claimed) Object.defineProperty(file, "size", { value: claimed });
  const dropped = new Event("drop", { bubbles: true, cancelable: true });
  Object.defineProperty(dropped, "dataTransfer", { value: { files: [file], types: ["Files"] } });
  window.dispatchEvent(dropped);
}, [name, [...bytes], size]);

const kDropped = Buffer.from("\x89MCAP0\r\n and so on", "latin1");

/// A file that is dropped is sent as it is; what the viewer makes of it is shown, with its notes, until the page is live again.
export async function aDroppedRecordingIsReadByTheViewer() {
  const world = hall();
  const run = runOf(hall(), ["breaks off in the record at byte 17; what stands before it was read"]);
  const page = await open(world);
  world.recording = () => ({ body: JSON.stringify(run) });
  await drop(page, "run.mcap", kDropped);
  await until("it is shown", async () => (await textOf(page, "#recording")).includes("run.mcap"));
  check(world.posted.length === 1 && world.posted[0].equals(kDropped), `the viewer was sent ${world.posted}`);
  await until("its notes are shown", async () => /run\.mcap: breaks off in the record at byte 17/.test(await textOf(page, "#answer-text")));
  await page.evaluate(() => {
    collidedPage.timeline.pause();
    collidedPage.timeline.goTo(1);
  });
  await until("its middle is shown", () => page.evaluate(() => !collidedPage.pendingPoses && collidedPage.world.byName.get("ball_1").position[0] === 1));
  await page.click("#live");
  world.objects[world.slotOf("ball_1")].pose[0] = 7;
  world.move(5);
  await until("the page is live", () => page.evaluate(() => document.getElementById("recording").hidden && collidedPage.world.byName.get("ball_1").position[0] === 7));
  await shut(page);
}

/// The page shows what is wrong with a file, and the page goes on as before.
export async function filesThatCannotBeShownAreRefused() {
  const world = hall();
  const page = await open(world);
  const refused = (why) => () => ({ status: 422, body: why });
  const cases = [
    ["notes.txt", refused("is no MCAP file. Nothing is shown"), /notes\.txt: is no MCAP file\. Nothing is shown/],
    ["torn.mcap", () => null, /torn\.mcap: the viewer broke off/],
    ["half.mcap", () => ({ body: "{" }), /half\.mcap: /],
    ["<img src=x onerror=\"window.isBroken=1\">", refused("nothing in it has a place"), /<img src=x.*nothing in it has a place/],
  ];
  for (const [name, answer, expected] of cases) {
    world.recording = answer;
    await drop(page, name, kDropped);
    await until(`${name} is refused`, async () => expected.test(await textOf(page, "#answer-text")));
  }
  const sent = world.posted.length;
  await drop(page, "large.mcap", kDropped, 2 ** 30 + 1);
  await until("it is refused for its size", async () => /large\.mcap has 1\D?025 MiB; a viewer reads 1\D?024 at most/.test(await textOf(page, "#answer-text")));
  check(world.posted.length === sent, "a file that is too large was sent");
  check(await page.evaluate(() => !window.isBroken && document.getElementById("recording").hidden), "one of them was opened, or read as HTML");
  world.objects[world.slotOf("ball_1")].pose[0] = 2;
  world.move(5);
  await until("the page is live", () => page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0] === 2));
  forgive(/422|ERR_FAILED/);  // the browser reports them as errors of the page
  await shut(page);
}

/// A saved page has no viewer, and says so.
export async function aSavedPageReadsNoRecordings() {
  const world = hall();
  const page = await openSaved(world);
  await drop(page, "run.mcap", kDropped);
  await until("it says why", async () => /this page is a saved run: it has no viewer that could read a recording/.test(await textOf(page, "#answer-text")));
  check(world.posted.length === 0, "a saved page sends files");
  await shut(page);
}
