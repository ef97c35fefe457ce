// What both tests of the page need: the browser, waiting, checking. Where there is no browser a test is skipped, exit code 77.
import { existsSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

export const words = Object.fromEntries(process.argv.slice(2).map((word, at, all) => [word.replace(/^--/, ""), all[at + 1] ?? true]));
const chromiumPath = process.env.CHROMIUM || "/usr/bin/chromium";

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}
if (!existsSync(chromiumPath)) skip(`no browser at ${chromiumPath}; apt-get install chromium`);
let playwright;
try {
  playwright = createRequire(join(words.modules, "x.js"))("playwright-core");
} catch {
  skip(`no playwright-core; npm install --prefix ${words.modules} playwright-core`);
}

export function launch(more = []) {
  return playwright.chromium.launch({
    executablePath: chromiumPath,
    args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
      ...(more.length ? more : ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"])],
  });
}

/// Waits for a condition; its value. Throws with what was waited for when the time is over.
export async function until(what, condition, seconds = 20) {
  const end = Date.now() + 1000 * seconds;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > end) throw new Error(`${what}: not within ${seconds} s`);
    await new Promise((done) => setTimeout(done, 25));
  }
}
export function check(holds, what) {
  if (!holds) throw new Error(what);
}

export async function picture(page, name) {
  if (!words.pictures) return;
  mkdirSync(words.pictures, { recursive: true });
  await page.screenshot({ path: join(words.pictures, `${name}.png`) });
}
