#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "idl/mcap/format.hpp"

namespace collided::mcap {

/// A message; its data are in the bytes that were read.
struct Message {
  MessageHead head;
  std::span<const std::byte> data;
};

/// What the messages of a channel look like, in a language that `encoding` names.
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

/// What a file holds, as far as it could be read.
struct Contents {
  std::map<std::uint16_t, Schema> schemas;                             // by number
  std::map<std::uint16_t, Channel> channels;                           // by number
  std::vector<Message> messages;                                       // in the order of the file
  std::map<std::string, std::map<std::string, std::string>> metadata;  // by the record's name
  bool is_mcap = false;
  bool complete = false;                // ends as a closed file does
  std::string damage;                   // where it breaks off and what that means; empty: nowhere
  std::uint64_t bad_chunks = 0;         // left out: their checksum or their lengths do not fit
  std::uint64_t compressed_chunks = 0;  // left out: only uncompressed ones are read
  std::uint64_t lost_messages = 0;      // left out: broken, or of a channel that no record describes
};

/// Reads any bytes; checks every length and every chunk's checksum. Records of unknown kinds are skipped. `bytes` must
/// outlive the messages.
///
/// memory  48 bytes a message, the smallest of which has 31 in the file; else no more than the bytes have
Contents read(std::span<const std::byte> bytes);

/// Reads a whole file into memory. Throws std::runtime_error with the path and the reason, such as more than
/// most_bytes.
std::vector<std::byte> read_file(const std::string& path, std::uint64_t most_bytes);

}  // namespace collided::mcap
