#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "idl/mcap/format.hpp"

namespace collided::mcap {

/// A message; its data is a view into the bytes that were read.
struct Message {
  MessageHead head;
  std::span<const std::byte> data;
};

/// The structure of a channel's messages, in the language named by `encoding`.
struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
};

/// A stream of messages of one topic.
struct Channel {
  std::uint16_t schema = 0;  // number of its schema; 0: none
  std::string topic;
  std::string encoding;  // of its messages
  std::map<std::string, std::string> metadata;
};

/// The readable contents of a file.
struct Contents {
  std::map<std::uint16_t, Schema> schemas;                             // by number
  std::map<std::uint16_t, Channel> channels;                           // by number
  std::vector<Message> messages;                                       // in the order of the file
  std::map<std::string, std::map<std::string, std::string>> metadata;  // by the record's name
  bool is_mcap = false;
  bool complete = false;                // has the end of a closed file
  std::string damage;                   // where it breaks off, and the consequence; empty: nowhere
  std::uint64_t bad_chunks = 0;         // left out: wrong checksum or lengths
  std::uint64_t compressed_chunks = 0;  // left out: only uncompressed ones are read
  std::uint64_t lost_messages = 0;      // left out: broken, or of a channel that no record describes
};

/// Reads any bytes; checks every length and every chunk's checksum. Records of unknown kinds are skipped. `bytes` must
/// outlive the messages.
///
/// memory  48 bytes per message, while the smallest has 31 in the file; otherwise no more than the bytes
Contents read(std::span<const std::byte> bytes);

/// Reads a whole file into memory. Throws std::runtime_error with the path and the reason, such as a size above
/// most_bytes.
std::vector<std::byte> read_file(const std::string& path, std::uint64_t most_bytes);

}  // namespace collided::mcap
