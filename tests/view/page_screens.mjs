// Tests of the page: panels, on every screen.
import { check, picture, until } from "./chromium.mjs";
import { FakeWorld } from "./fake_viewer.mjs";
import { hall, open, shut, textOf } from "./page_fixture.mjs";

/// Nothing runs out of its place, events have their depth, and what is over the picture leaves the panels free.
export async function fitsEveryScreen() {
  for (const [width, height] of [[360, 740], [700, 900], [768, 1024], [1024, 768], [1280, 800], [2560, 1440]]) {
    const world = hall();
    const page = await open(world, { width, height, touch: width < 800 && width !== 700, night: width === 1280 });
    await page.selectOption("#tool", "sphere");
    if (width < 700) await page.tap("#tabs [data-panel=panel-events]");
    // Last, since the page forgets what is older than 30 s, and a tap may take as long on a busy machine.
    world.tell({ type: "events", left_out: 0, events: [world.event("began", "warehouse/north/shelf_17/upper", "fleet/robots/carrier_0042/bumper")] });
    await until("the event is listed", async () => /12.3 mm/.test(await textOf(page, "#events")));
    const found = await page.evaluate(() => {
      const box = (one) => one.getBoundingClientRect();
      const scene = box(document.getElementById("scene"));
      const panels = [...document.querySelectorAll("aside")].map(box).filter(({ width: wide, height: high }) => wide && high);
      return {
        page: document.documentElement.scrollWidth, screen: innerWidth, scene: [scene.width, scene.height],
        covered: panels.some((one) => one.left < scene.right - 1 && one.right > scene.left + 1 && one.top < scene.bottom - 1 && one.bottom > scene.top + 1),
        depth: (() => {
          const depth = document.querySelector("#events .depth");
          const { left, right } = box(depth);
          return depth.scrollWidth <= depth.clientWidth + 1 && left >= 0 && right <= innerWidth;
        })(),
        over: (() => {
          const text = box(document.getElementById("quality"));
          return [...document.querySelectorAll("#tools > *")].filter((one) => {
            const { left, right, top, bottom, width: wide } = box(one);
            return wide && left < text.right && right > text.left && top < text.bottom && bottom > text.top;
          }).map(({ id }) => id);
        })(),
        cut: [...document.querySelectorAll("#events .pair, #events time")].some((one) => one.scrollWidth > one.clientWidth + 1 && one.clientWidth > 0),
        small: matchMedia("(pointer: coarse)").matches ? [...document.querySelectorAll("button, select, summary")].filter((one) => box(one).height && box(one).height < 44 && box(one).width).map((one) => `${one.id || one.className || one.textContent} ${box(one).height}`) : [],
      };
    });
    const where = `${width}x${height}`;
    check(found.page <= found.screen, `${where}: the page is ${found.page} wide`);
    check(found.scene[0] >= 0.4 * width && found.scene[1] >= 0.4 * height, `${where}: the picture has ${found.scene}`);
    check(!found.covered, `${where}: a panel lies over the picture`);
    check(found.over.length === 0, `${where}: the text about the picture covers ${found.over}`);
    check(found.depth, `${where}: the depth is cut off`);
    check(!found.cut, `${where}: an event is cut off`);
    check(found.small.length === 0, `${where}: too small to touch: ${found.small.join(", ")}`);
    const { used, free } = await page.evaluate(() => {
      const { camera, world: { bounds } } = collidedPage;
      collidedPage.fitAll();
      const scene = document.getElementById("scene").getBoundingClientRect();
      const seen = bounds.corners().map((corner) => camera.project(corner));
      const x = seen.map(([part]) => scene.left + ((part + 1) / 2) * scene.width);
      const y = seen.map(([, part]) => scene.top + ((1 - part) / 2) * scene.height);
      const box = (id) => document.getElementById(id).getBoundingClientRect();
      return { used: [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)], free: [scene.left, box("title").bottom, scene.right, box("timeline").top] };
    });
    const isInside = used[0] >= free[0] && used[1] >= free[1] && used[2] <= free[2] && used[3] <= free[3];
    check(isInside, `${where}: the world is seen from ${used}, what is free is ${free}`);
    const fills = Math.max((used[2] - used[0]) / (free[2] - free[0]), (used[3] - used[1]) / (free[3] - free[1]));
    check(fills > 0.8, `${where}: the world fills ${fills} of what is free`);
    await picture(page, `screen_${where}`);
    await shut(page);
  }
}

/// The label of the pointer stays in the picture, whatever its length and wherever the pointer is.
export async function labelsStayInThePicture() {
  const world = new FakeWorld().box("x".repeat(200), [0, 0, -0.1], [400, 400, 0.1], { scene: "hall" }).sphere("ball", [0, 0, 1], 0.5);
  const page = await open(world);
  await page.evaluate(() => Object.assign(collidedPage.camera, { distance: 30, pitch: 1.2, isTouched: true }));
  const scene = await page.locator("#scene").boundingBox();
  for (const [x, y] of [[0.99, 0.6], [0.5, 0.7], [0.98, 0.7]]) {
    await page.mouse.move(scene.x + x * scene.width, scene.y + y * scene.height);
    await until(`the label is there at ${x} ${y}`, () => page.evaluate(() => !document.getElementById("label").hidden));
    const label = await page.locator("#label").boundingBox();
    check(label.x >= scene.x && label.x + label.width <= scene.x + scene.width + 1, `at ${x}: the label is from ${label.x} to ${label.x + label.width}, the picture from ${scene.x} to ${scene.x + scene.width}`);
    await page.mouse.move(scene.x + 300, 5);
  }
  await shut(page);
}

/// Text is told apart from its ground as WCAG 2.2 (1.4.3, level AA) asks, by day and by night; choices are kept.
export async function textIsLegible() {
  for (const night of [false, true]) {
    const page = await open(hall(), { night });
    const ratios = await page.evaluate(() => {
      const style = getComputedStyle(document.documentElement);
      const luminance = (name) => {
        const text = style.getPropertyValue(name).trim();
        const parts = [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2];
      };
      const ratio = (a, b) => (Math.max(luminance(a), luminance(b)) + 0.05) / (Math.min(luminance(a), luminance(b)) + 0.05);
      return ["--ink", "--quiet", "--accent-text"].flatMap((text) => ["--paper", "--raised"].map((ground) => [text, ground, ratio(text, ground)]));
    });
    for (const [text, ground, ratio] of ratios) check(ratio >= 4.5, `${night ? "night" : "paper"}: ${text} on ${ground} is ${ratio.toFixed(2)}; 4.5 is the least`);
    const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas[tabindex], [role=tree]")].filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim() || one.labels?.length)).map((one) => one.id));
    check(unnamed.length === 0, `without a name: ${unnamed.join(", ")}`);
    if (!night) {
      await page.click("#panel-stages summary");
      await until("that is kept", () => page.evaluate(() => localStorage.getItem("collided panel-stages") === "false"));
      await page.reload();
      await until("it stays folded", () => page.evaluate(() => window.collidedPage && !document.getElementById("panel-stages").open));
    }
    await shut(page);
  }
}
