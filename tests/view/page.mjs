// The page in a real browser, with a viewer made here, so that each test knows what must be seen.
//   node page.mjs --source client/view --modules DIR [--pictures DIR] [--only TEST]
import { check, words } from "./chromium.mjs";
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

const tests = [isSmall, ...[picture, things, asking, recording, screens, memory].flatMap((all) => Object.values(all))];
try {
  await startBrowser();
  for (const test of tests.filter(({ name }) => !words.only || name === words.only)) {
    const begun = Date.now();
    try {
      await test();
      check(wrong.length === 0, `the page's errors: ${wrong.splice(0).join("; ")}`);
      console.log(`${test.name}: as it should be, ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    } catch (failed) {
      console.error(`${test.name}: ${failed.message}${wrong.length ? ` (the page's errors: ${wrong.splice(0).join("; ")})` : ""}`);
      process.exitCode = 1;
      await closeAll();
    }
  }
} finally {
  await stopBrowser();
}
