// Chromium, for the tests of the page. Where it is not installed a test is skipped.
import { existsSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { skip, words } from "./waiting.mjs";

export { check, until, words } from "./waiting.mjs";
const chromiumPath = process.env.CHROMIUM || "/usr/bin/chromium";

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

export async function picture(page, name) {
  if (!words.pictures) return;
  mkdirSync(words.pictures, { recursive: true });
  await page.screenshot({ path: join(words.pictures, `${name}.png`) });
}
