// The samples in recordings: plain CDR (OMG, "DDS for Extensible and Dynamic Topic Types" 1.3, 7.4: XCDR version 1), with the
// members of idl/collided.idl in their order (kSamples).
const kMembers = Object.fromEntries(Object.entries(kSamples).map(([type, text]) => [type, text.split(",").map((member) => member.trim().split(/\s+/))]));
const kWidths = { u8: 1, u32: 4, u64: 8, i64: 8, f64: 8 };

/// Reads a sample from a DataView of its bytes. Throws where they are none.
function readSample(type, view) {
  const isLittle = view.getUint8(1) === 1;
  if (!isLittle) throw new Error("a sample is not little-endian CDR");
  const header = 4;
  let at = header;
  const align = (width) => { at = header + Math.ceil((at - header) / width) * width; };
  const take = (width) => {
    align(Math.min(8, width));
    const here = at;
    at += width;
    return here;
  };
  const numbers = {
    u8: () => view.getUint8(take(1)), u32: () => view.getUint32(take(4), true), f64: () => view.getFloat64(take(8), true),
    u64: () => wideNumber(view, take(8)), i64: () => Number(view.getBigInt64(take(8), true)),
  };
  const list = (kind, count) => {
    if (count > 0) align(kWidths[kind]);
    const from = view.byteOffset + at;
    if (at + count * kWidths[kind] > view.byteLength) throw new Error("a list is longer than its sample");
    if (kind !== "u8" && kind !== "f64" && kind !== "u32") return Array.from({ length: count }, numbers[kind]);
    at += count * kWidths[kind];
    const bytes = view.buffer.slice(from, view.byteOffset + at);
    return kind === "u8" ? new Uint8Array(bytes) : kind === "u32" ? new Uint32Array(bytes) : new Float64Array(bytes);
  };
  const sample = {};
  for (const [name, kind] of kMembers[type]) {
    if (kind === "text") sample[name] = new TextDecoder().decode(list("u8", numbers.u32())).replace(/\0$/, "");
    else if (kind.endsWith("*")) sample[name] = list(kind.slice(0, -1), numbers.u32());
    else if (kind.endsWith("]")) sample[name] = [...list("f64", Number(kind.slice(4, -1)))];
    else sample[name] = numbers[kind]();
  }
  return sample;
}

/// 64 bits as a number, or as text if a double cannot hold them, as of the random numbers of servers, publishers and clients,
/// which are only compared. Ids of objects, sequence numbers and times stay below 2^53.
const wideNumber = (view, at) => {
  const high = view.getUint32(at + 4, true);
  return high < 2 ** 21 ? view.getUint32(at, true) + 4294967296 * high : String(view.getBigUint64(at, true));
};
const zeroTerminated = (bytes) => new TextDecoder().decode(bytes).split("\0").slice(0, -1);
