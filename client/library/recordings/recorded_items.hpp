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

/// One recorded sample. Its data points into the recording's bytes.
struct RecordedItem {
  recording::Recorded topic{};
  std::uint64_t log_time = 0;  // when it was received: ns since 1970 by the recorder's clock
  std::span<const std::byte> data;
  bool opening = false;  // part of the state at the start of the recording
};

/// A message of a channel that is not a topic of the namespace (OwnChannel). Its data points into the recording's bytes.
struct RecordedOwnMessage {
  std::string schema_name;
  std::uint64_t log_time = 0;
  std::span<const std::byte> data;
};

/// A recording's samples. It owns the bytes that its items point into.
struct RecordedItems {
  std::vector<std::byte> bytes;
  std::vector<RecordedItem> items;      // those of the opening first, then by time
  std::vector<RecordedOwnMessage> own;  // by time
  std::vector<std::string> warnings;
  bool has_opening = false;
};

/// The bytes of a whole file. Throws std::runtime_error with the path and the reason.
std::vector<std::byte> read_recording(const std::string& path);

/// Reads the samples of a recording. Throws std::runtime_error, with the name and the reason, if it has none of a
/// collision server.
///
/// name         of the recording, for errors and warnings
/// consequence  what the failure means, as the end of the error
RecordedItems read_items(std::vector<std::byte> bytes, const std::string& name, const char* consequence);

}  // namespace collided::client
