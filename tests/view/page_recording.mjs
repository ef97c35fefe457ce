// Tests of the page: files that are no recordings. browser.mjs opens real ones.
import { check, until } from "./chromium.mjs";
import { hall, open, shut, textOf } from "./page_fixture.mjs";

const text = (words) => {
  const bytes = Buffer.from(words);
  const size = Buffer.alloc(4);
  size.writeUInt32LE(bytes.length);
  return Buffer.concat([size, bytes]);
};
const record = (opcode, ...parts) => {
  const content = Buffer.concat(parts);
  const head = Buffer.alloc(9);
  head.writeUInt8(opcode);
  head.writeBigUInt64LE(BigInt(content.length), 1);
  return Buffer.concat([head, content]);
};
const number = (value, bytes) => {
  const out = Buffer.alloc(bytes);
  out.writeUIntLE(value, 0, Math.min(6, bytes));
  return out;
};
const kMagic = Buffer.from([0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a]);
const described = (type, topic) => [record(3, number(1, 2), text(`collided::wire_v2::${type}`), text("omgidl"), text("")), record(4, number(1, 2), number(1, 2), text(topic), text("cdr"), number(0, 4))];
const message = (bytes) => record(5, number(1, 2), number(1, 4), number(1000, 8), number(1000, 8), bytes);

/// Drops bytes on the page as a file.
const drop = (page, name, bytes) => page.evaluate(([called, numbers]) => {
  const data = new DataTransfer();
  data.items.add(new File([new Uint8Array(numbers)], called));
  window.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
}, [name, [...bytes]]);

/// What is wrong with a file is said, and the page goes on as before.
export async function filesThatAreNoRecordingsAreRefused() {
  const world = hall();
  const page = await open(world);
  const cases = [
    ["notes.txt", Buffer.from("# notes\n"), /notes\.txt: this is no MCAP file/],
    ["nothing.mcap", kMagic, /nothing\.mcap: the recording has no messages/],
    ["noise.mcap", Buffer.concat([kMagic, ...described("Definition", "collided/object_v2"), message(Buffer.from("0001000012345678", "hex"))]), /nothing in it has a place/],
    ["huge.mcap", Buffer.concat([kMagic, ...described("PoseBatch", "collided/pose_v2"), message(Buffer.concat([Buffer.from([0, 1, 0, 0]), Buffer.alloc(48, 255)])), Buffer.from([5, 255, 255, 255, 255, 255, 255, 255, 127])]), /nothing in it has a place/],
    ["<img src=x onerror=\"window.isBroken=1\">", Buffer.from("x"), /<img src=x/],
  ];
  for (const [name, bytes, expected] of cases) {
    await drop(page, name, bytes);
    await until(`${name} is refused`, async () => expected.test(await textOf(page, "#answer-text")));
  }
  check(await page.evaluate(() => !window.isBroken && document.getElementById("recording").hidden), "one of them was opened, or read as HTML");
  world.objects[world.slotOf("ball_1")].pose[0] = 2;
  world.move(5);
  await until("the page is live", () => page.evaluate(() => collidedPage.world.byName.get("ball_1").position[0] === 2));
  await shut(page);
}
