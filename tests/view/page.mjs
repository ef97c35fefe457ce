// The page in a real browser, with a viewer made here, so that each test knows what must be seen.
//   node page.mjs --source client/view --modules DIR [--pictures DIR] [--only TEST]
import { check, words } from "./chromium.mjs";
import { lastChecked } from "./waiting.mjs";
import * as asking from "./page_asking.mjs";
import { closeAll, files, startBrowser, stopBrowser, wrong } from "./page_fixture.mjs";
import * as memory from "./page_memory.mjs";
import * as picture from "./page_picture.mjs";
import * as recording from "./page_recording.mjs";
import * as screens from "./page_screens.mjs";
import * as things from "./page_things.mjs";

/// Nothing but these three files is needed, and they are small.
function isSmall() {
  const bytes = Object.values(files).reduce((sum, [, text]) => sum + Buffer.byteLength(text), 0);
  check(bytes < 300e3, `the page has ${bytes} bytes`);
  console.log(`size: ${(bytes / 1e3).toFixed(0)} kB`);
}

/// Whatever ends this program, its output says in which test, and what was waited for or checked last.
let current = "the browser's start";
function fail(failed) {
  const text = `${current}: ${failed.stack?.includes(failed.message) ? failed.stack : failed.message}${lastChecked() ? `\n  after ${lastChecked()}` : ""}${wrong.length ? `\n  the page's errors: ${wrong.splice(0).join("; ")}` : ""}`;
  console.error(text);
  failures.push(text.split("\n")[0]);
  process.exitCode = 1;
}
const failures = [];
for (const end of ["uncaughtException", "unhandledRejection"]) process.on(end, (failed) => { fail(failed instanceof Error ? failed : new Error(String(failed))); process.exit(1); });
// ctest kills a test after 1800 s without a word.
const most_s = 1700;
setTimeout(() => { fail(new Error(`not over within ${most_s} s`)); process.exit(1); }, 1000 * most_s).unref();

const tests = [isSmall, ...[picture, things, asking, recording, screens, memory].flatMap((all) => Object.values(all))];
try {
  await startBrowser();
  for (const test of tests.filter(({ name }) => !words.only || name === words.only)) {
    const begun = Date.now();
    current = test.name;
    try {
      await test();
      check(wrong.length === 0, `the page's errors: ${wrong.splice(0).join("; ")}`);
      console.log(`${test.name}: as it should be, ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    } catch (failed) {
      fail(failed);
      await closeAll();
    }
  }
} catch (failed) {
  fail(failed);
} finally {
  current = "the browser's end";
  await stopBrowser();
}
if (failures.length > 0) console.error(`\n${failures.length} failed:\n${failures.join("\n")}`);
process.exit();
