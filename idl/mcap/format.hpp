#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

/// The layout of MCAP files (https://mcap.dev/spec, version 0): records of an opcode, a length and content; messages in
/// chunks; a summary at the end. All numbers are little-endian.
namespace collided::mcap {

inline constexpr std::array<unsigned char, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

/// The kinds of records.
enum class Opcode : std::uint8_t {
  header = 1,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  attachment,
  attachment_index,
  statistics,
  metadata,
  metadata_index,
  summary_offset,
  data_end
};

inline constexpr std::size_t kRecordPrefixBytes = 9;    // opcode, length
inline constexpr std::size_t kMessagePrefixBytes = 31;  // record prefix, channel, number, two times
inline constexpr std::size_t kChunkPrefixBytes = 49;  // record prefix, two times, size, checksum, no compression, size

/// The part of a message before its data.
struct MessageHead {
  std::uint16_t channel = 0;
  std::uint32_t number = 0;        // among the messages of the channel
  std::uint64_t log_time = 0;      // when it was recorded, ns since 1970
  std::uint64_t publish_time = 0;  // when it was sent, ns since 1970
};

namespace detail {
template <class Number>
std::byte* put(std::byte* out, Number number) {
  std::memcpy(out, &number, sizeof number);
  return out + sizeof number;
}
}  // namespace detail

/// Writes the beginning of a message record. Safe in a signal handler, like the next function.
///
/// out  kMessagePrefixBytes; the message's data follows
inline void put_message_prefix(std::byte* out, const MessageHead& head, std::uint64_t data_bytes) {
  out = detail::put(out, Opcode::message);
  out = detail::put(out, kMessagePrefixBytes - kRecordPrefixBytes + data_bytes);
  out = detail::put(out, head.channel);
  out = detail::put(out, head.number);
  out = detail::put(out, head.log_time);
  detail::put(out, head.publish_time);
}

/// Writes the beginning of a chunk record.
///
/// out  kChunkPrefixBytes; the chunk's records follow, uncompressed
/// crc  of the records; 0: unknown
inline void put_chunk_prefix(std::byte* out, std::uint64_t first_time, std::uint64_t last_time,
                             std::uint64_t records_bytes, std::uint32_t crc) {
  out = detail::put(out, Opcode::chunk);
  out = detail::put(out, kChunkPrefixBytes - kRecordPrefixBytes + records_bytes);
  out = detail::put(out, first_time);
  out = detail::put(out, last_time);
  out = detail::put(out, records_bytes);
  out = detail::put(out, crc);
  out = detail::put(out, std::uint32_t{0});  // the compression's name is empty
  detail::put(out, records_bytes);
}

/// Assembles the bytes of records.
class Bytes {
 public:
  template <class Number>
  void number(Number value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void raw(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    raw(std::as_bytes(std::span(text)));
  }
  /// Begins a record with its opcode and space for its length. end() takes the returned value and fills in the length,
  /// including `to_come` bytes that are added later.
  std::size_t begin(Opcode opcode) {
    number(opcode);
    number(std::uint64_t{0});
    return bytes_.size();
  }
  void end(std::size_t begin, std::size_t to_come = 0) {
    patch(begin - 8, static_cast<std::uint64_t>(bytes_.size() - begin + to_come));
  }
  /// Begins an array or a map, preceded by its length in bytes, which end_list() fills in.
  std::size_t begin_list() {
    number(std::uint32_t{0});
    return bytes_.size();
  }
  void end_list(std::size_t begin) { patch(begin - 4, static_cast<std::uint32_t>(bytes_.size() - begin)); }

  std::span<const std::byte> all() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  template <class Number>
  void patch(std::size_t at, Number value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  std::vector<std::byte> bytes_;
};

}  // namespace collided::mcap
