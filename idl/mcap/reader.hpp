#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "idl/mcap/format.hpp"

namespace collided::mcap {

/// Data lie in the bytes that were read.
struct Message {
  MessageHead head;
  std::span<const std::byte> data;
};

struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
};

struct Channel {
  std::uint16_t schema = 0;  // its number; 0: none
  std::string topic;
  std::string encoding;  // of its messages
  std::map<std::string, std::string> metadata;
};

/// What a file holds, as far as it can be read.
struct Contents {
  std::map<std::uint16_t, Schema> schemas;  // by number
  std::map<std::uint16_t, Channel> channels;
  std::vector<Message> messages;                                       // in the order of the file
  std::map<std::string, std::map<std::string, std::string>> metadata;  // by the record's name
  bool is_mcap = false;
  bool complete = false;                // ends as a closed file does
  std::string damage;                   // where it breaks off and what that means, or empty
  std::uint64_t bad_chunks = 0;         // left out: their checksum is another, or their lengths do not fit
  std::uint64_t compressed_chunks = 0;  // left out: only what is not compressed is read
  std::uint64_t lost_messages = 0;      // left out: of a channel that no record describes, or broken
};

/// Takes any bytes; checks every length and every chunk's checksum. Records of kinds not known here are passed over.
///
/// memory  48 bytes a message, of which the smallest has 31 in the file; else no more than the bytes have
Contents read(std::span<const std::byte> bytes);

/// A whole file in memory; throws std::runtime_error with the path and the reason, or the limit where it is larger.
std::vector<std::byte> read_file(const std::string& path, std::uint64_t most_bytes);

}  // namespace collided::mcap
