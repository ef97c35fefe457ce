#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "idl/recording/recorded_topics.hpp"

namespace collided::client {

/// One recorded sample, in the recording's bytes.
struct RecordedItem {
  recording::Recorded topic{};
  std::uint64_t log_time = 0;
  std::span<const std::byte> data;
  bool opening = false;  // of the state before the recording
};

/// A recording's samples. Owns the bytes that its items lie in.
struct RecordedItems {
  std::vector<std::byte> bytes;
  std::vector<RecordedItem> items;  // the opening, then by time
  std::vector<std::string> warnings;
  bool has_opening = false;
};

/// A whole file; throws std::runtime_error with the path and the reason.
std::vector<std::byte> read_recording(const std::string& path);

/// Throws std::runtime_error with the name and what is wrong where there is nothing of a collision server.
///
/// name         for the sentences
/// consequence  of such a failure, the end of its sentence
RecordedItems read_items(std::vector<std::byte> bytes, const std::string& name, const char* consequence);

}  // namespace collided::client
