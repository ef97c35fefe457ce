// Tests of the page: what it keeps in memory. page_open_long.mjs looks at a page that is open for as long, with all of its processes.
import { check } from "./chromium.mjs";
import { hall, open, shut } from "./page_fixture.mjs";

/// An hour of what a server says, in a moment: the page keeps 30 s of it, whether things move or not.
export async function anHourIsForgotten() {
  const world = hall();
  const page = await open(world);
  const session = await page.context().newCDPSession(page);
  const status = world.status({ publishers: Array.from({ length: 20 }, (_, i) => ({ name: `publisher_${i}`, messages: 1, silent: 0.1, lost: false })) });
  const contact = world.event("began", "ball", "floor");
  const hear = (from, until, moves) => page.evaluate(([begin, end, isMoving, status, contact]) => {
    const { timeline } = collidedPage;
    const frame = (window.heardFrame ||= timeline.history.frames.at(-1).value);
    const start = timeline.history.end;
    for (let i = 0; i < 20 * (end - begin); ++i) {
      const t = start + i / 20;
      if (isMoving) timeline.hear("poses", { ...frame, numbers: frame.numbers.slice() }, t);
      if (i % 10) continue;
      timeline.hear("status", structuredClone(status), t);
      const met = { ...contact, a: `ball_${begin + i / 20}` };
      for (const what of ["began", "ended"]) timeline.hear("events", { events: [{ ...met, what, why: "separated" }] }, t);
    }
  }, [from, until, moves, status, contact]);
  const kept = async () => {
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize } = await session.send("Runtime.getHeapUsage");
    const counts = await page.evaluate(() => Object.fromEntries(["frames", "changes", "others", "tables", "standing"].map((list) => [list, collidedPage.timeline.history[list].length])));
    return { heap: usedSize / 1e6, ...counts };
  };
  // Contacts that are over are kept too, 2,000 of them: there are as many after 20 minutes.
  for (const [what, moves] of [["things move", true], ["nothing moves", false]]) {
    await hear(0, 1200, moves);
    const early = await kept();
    await hear(1200, 3600, moves);
    const late = await kept();
    for (const list of ["frames", "changes", "others", "tables", "standing"]) check(late[list] <= early[list] + 25, `${what}: ${late[list]} ${list} after an hour, ${early[list]} after 20 minutes`);
    check(late.others <= 70, `${what}: ${late.others} statuses; two a second of 30 s are 60`);
    check(await page.evaluate(() => Boolean(collidedPage.timeline.history.frameAt(collidedPage.timeline.begin()))), `${what}: going back shows no poses`);
    const most = 3;  // MB; what the browser compiles comes and goes. A status of 20 publishers has 2 kB, those of 40 minutes have 10 MB
    check(late.heap - early.heap <= most, `${what}: the page's memory goes from ${early.heap.toFixed(2)} to ${late.heap.toFixed(2)} MB`);
    console.log(`memory: ${early.heap.toFixed(2)} MB after 20 minutes, ${late.heap.toFixed(2)} MB after an hour in which ${what}`);
  }
  await shut(page);
}
