// Reads messages of ROS 2 with the npm packages that Foxglove reads them with.
//   node foxglove_reader.mjs --modules DIR FILE
// FILE has a line "raw TYPE HEX" for each message: what came over the wire, with its encapsulation header. Prints a line of JSON
// for each: {type, message, is_whole (all bytes were read), is_same (written again by these packages, it has the same bytes)}. Reads
// each with the definitions of every distribution that is supported, which must agree.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const kDistributions = ["ros2humble", "ros2iron", "ros2jazzy"];
/// ros_gz_interfaces/msg/Contacts, which is in no common package.
const kContacts = `std_msgs/Header header
ros_gz_interfaces/Contact[] contacts
===
MSG: ros_gz_interfaces/Contact
ros_gz_interfaces/Entity collision1
ros_gz_interfaces/Entity collision2
geometry_msgs/Vector3[] positions
geometry_msgs/Vector3[] normals
float64[] depths
ros_gz_interfaces/JointWrench[] wrenches
===
MSG: ros_gz_interfaces/Entity
uint64 id
string name
uint8 type
===
MSG: ros_gz_interfaces/JointWrench
std_msgs/Header header
std_msgs/String body_1_name
std_msgs/UInt32 body_1_id
std_msgs/String body_2_name
std_msgs/UInt32 body_2_id
geometry_msgs/Wrench body_1_wrench
geometry_msgs/Wrench body_2_wrench
`;

const [, , option, modules, file] = process.argv;
if (option !== "--modules" || !file) throw new Error("usage: node foxglove_reader.mjs --modules DIR FILE");
const load = createRequire(join(modules, "x.js"));
let packages;
try {
  packages = ["@foxglove/rosmsg", "@foxglove/rosmsg2-serialization", "@foxglove/rosmsg-msgs-common"].map((name) => load(name));
} catch {
  console.log(`skipped: no @foxglove/rosmsg and its like in ${modules}; deploy/install --tests BUILD`);
  process.exit(77);
}
const [{ parse }, { MessageReader, MessageWriter }, common] = packages;

/// A type's definition, and after it those of all that it is made of.
function definitionsOf(type, known) {
  const own = type === "ros_gz_interfaces/Contacts" ? parse(kContacts, { ros2: true, skipTypeFixup: true }) : [known[type]];
  const found = new Map(own.map((one) => [one.name ?? type, one]));
  for (const { definitions } of found.values()) {
    for (const { type: member, isComplex } of definitions) if (isComplex && !found.has(member)) found.set(member, known[member]);
  }
  return [...found.values()];
}

const asJson = (value) => JSON.stringify(value, (_, part) => (typeof part === "bigint" ? Number(part) : ArrayBuffer.isView(part) ? [...part] : part));

for (const line of readFileSync(file, "utf8").split("\n")) {
  const [word, type, hex] = line.split(" ");
  if (word !== "raw") continue;
  const bytes = Buffer.from(hex, "hex");
  const read = kDistributions.map((distribution) => {
    const definitions = definitionsOf(type, common[distribution]);
    const reader = new MessageReader(definitions);
    const message = reader.readMessage(bytes);
    const again = new MessageWriter(definitions).writeMessage(message);
    // The header's last byte says how much fills up a multiple of four.
    const padding = bytes[3] & 3;
    const isSame = Buffer.compare(bytes.subarray(4, bytes.length - padding), again.subarray(4)) === 0;
    return asJson({ type, message, is_whole: reader.lastReadByteLength() >= bytes.length - padding, is_same: isSame });
  });
  if (read.some((one) => one !== read[0])) throw new Error(`${type} is not alike in ${kDistributions}`);
  console.log(read[0]);
}
