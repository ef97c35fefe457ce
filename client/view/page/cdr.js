// The samples in recordings: plain CDR (OMG, "DDS for Extensible and Dynamic Topic Types" 1.3, 7.4: XCDR version 1), with the
// members of idl/collided.idl in their order. A key is a number of 64 bits that is only compared; "x" skips.
const kSamples = {
  Definition: `publisher key, object_number u32, incarnation u64, sequence_number u64, removed u8, moving u8, lost_policy u8, publisher_name text,
    name text, layers u32, mask u32, group u32, position f64[3], orientation f64[4], shape u8*`,
  PoseBatch: `publisher key, incarnation u64, sequence_number u64, definitions_through u64, source_time_ns i64, flags u8, object_numbers u32*,
    positions f64*, orientations f64*`,
  Query: `client key, request key, chunk_index u32, chunk_count u32, first_question u32, kind u8, mode u8, importance u8, instant u8, instant_ns i64,
    mask u32, max_hits u32, deadline_ns i64, error_asked f64, barrier_publisher key, barrier_sequence u64, only text, skip text, x f64*, x f64*,
    x f64*, x f64*, x f64*, x f64*, x f64*, x f64*, text text, blob u8*`,
  Reply: `client key, request key, chunk_index u32, chunk_count u32, first_question u32, status u8, server key, epoch u64, version u64, world_time_ns i64,
    x i64, x i64, x u8*, x u8*, x u8*, x u32*, x u32*, x u32*, x u64*, x u32*, x u8*, x f64*, x f64*, x f64*, x f64*, x f64*, x f64*, x f64*, x f64*,
    x f64*, x f64*, x u32*, x f64*, x f64*, x u64*, x u8*, text u8*`,
  EventFrame: `server key, epoch u64, first_sequence u64, version u64, world_time_ns i64, kinds u8*, reasons u8*, doubts u8*, shards u8*, a u64*,
    b u64*, a_triangles u32*, b_triangles u32*, episodes u64*, points f64*, normals f64*, depths f64*, depth_errors f64*, x f64*, x f64*, x f64*,
    bracket_lows f64*, bracket_highs f64*, velocities f64*, velocity_errors f64*, named_ids u64*, names u8*`,
  ContactShard: `server key, shard u8, epoch u64, version u64, as_of_sequence u64, doubts u8*, a u64*, b u64*, a_triangles u32*, b_triangles u32*,
    episodes u64*, began_ns i64*, points f64*, normals f64*, depths f64*, depth_errors f64*, x f64*, x f64*, x f64*, named_ids u64*, names u8*`,
  Status: `server key, epoch u64, version u64, world_time_ns i64, last_event_sequence u64, contact_count u32, contact_hash key,
    contacts_truncated u8, state u8, pid u32, namespace_name text, server_version text, scenes text, static_triangles u64, object_count u32,
    moving_count u32, x u64, x u64, x u64, x u64, undecided_answers u64, publishers key*, applied_sequences u64*, silent_ns i64*,
    publisher_states u8*, publisher_names u8*`,
};
const kMembers = Object.fromEntries(Object.entries(kSamples).map(([type, text]) => [type, text.split(",").map((member) => member.trim().split(/\s+/))]));
const kWidths = { u8: 1, u32: 4, u64: 8, i64: 8, f64: 8, key: 8 };

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
    u64: () => wideNumber(view, take(8)), i64: () => Number(view.getBigInt64(take(8), true)), key: () => view.getBigUint64(take(8), true).toString(16),
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

/// 64 bits as a double: exact up to 2^53, which ids and sequence numbers stay below.
const wideNumber = (view, at) => view.getUint32(at, true) + 4294967296 * view.getUint32(at + 4, true);
const zeroTerminated = (bytes) => new TextDecoder().decode(bytes).split("\0").slice(0, -1);
