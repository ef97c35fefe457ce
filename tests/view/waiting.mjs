// Arguments, waiting and checking, for tests with and without a browser. What a test needs and is not there makes it skipped: exit code 77.
export const words = Object.fromEntries(process.argv.slice(2).map((word, at, all) => [word.replace(/^--/, ""), all[at + 1] ?? true]));

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

/// What until() or check() looked at last, for the message of a test that fails elsewhere.
let looked = "";
export const lastChecked = () => looked;

/// Waits for a condition; its value. Throws with what was waited for when the time is over, which is long, since a busy machine is
/// no fault of the page.
export async function until(what, condition, seconds = 60) {
  looked = `waiting for "${what}"`;
  const end = Date.now() + 1000 * seconds;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > end) throw new Error(`${what}: not within ${seconds} s`);
    await new Promise((done) => setTimeout(done, 25));
  }
}
export function check(holds, what) {
  looked = `the check "${what}"`;
  if (!holds) throw new Error(what);
}
