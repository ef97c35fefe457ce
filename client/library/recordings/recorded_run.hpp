#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "client/library/recordings/recorded_items.hpp"
#include "idl/cdr.hpp"

namespace collided::client {

/// A state of the recorded server: how far each publisher's messages were applied in it.
struct RecordedState {
  std::map<std::uint64_t, std::uint64_t> applied;  // sequence number, by publisher
  std::set<std::uint64_t> lost;                    // publishers
};
using StateNumber = std::pair<std::uint64_t, std::uint64_t>;  // epoch, version

/// One request and its replies.
struct RecordedRequest {
  std::vector<std::size_t> questions;  // indexes of items, by chunk
  std::vector<std::size_t> replies;
};

/// The publisher of a definition or batch of poses.
struct RecordedOrigin {
  std::uint64_t publisher = 0;  // 0: it is of another topic
  std::uint64_t incarnation = 0;
  std::int64_t stamp_ns = 0;  // of poses, by the publisher's clock; 0: none
};

/// A command that the server carried out.
struct RecordedCommand {
  std::size_t query = 0;  // index of its item
  std::string answer;     // JSON; empty: the recording has none, as of the opening
};

/// A recording, sorted for replay.
struct RecordedRun : RecordedItems {
  std::vector<RecordedOrigin> origins;  // by item
  std::map<StateNumber, RecordedState> states;
  std::map<StateNumber, std::vector<RecordedRequest>>
      requests;  // questions about the world, by the state that they were about
  std::map<StateNumber, std::vector<std::size_t>>
      commands;  // indexes of items that changed the world, by the state that they made: queries, and farewells
  /// Commands that changed the world, with those that load and clear scenes. By the index of the item at which they took
  /// effect: the last reply, or the command itself if it needs none.
  std::map<std::size_t, RecordedCommand> carried_out;
  std::map<std::uint64_t, std::uint64_t> opening_through;  // by publisher: its newest message in the opening
  std::uint64_t unanswered = 0;                            // requests without all of their replies
  std::uint64_t changing_files = 0;                        // number of commands load and clear, which are not replayed
  std::string scenes;                                      // names, one a line, from the newest status
};

/// Whether it says that its client has gone, and took standing questions along: a reply to no request.
bool is_farewell(const wire::Reply& reply);

/// Reads a recording for replay. Throws std::runtime_error with the path and the reason where nothing can be replayed.
RecordedRun read_run(const std::string& path);
/// The same for bytes.
///
/// name         of the recording, for errors and warnings
/// consequence  what the failure means, as the end of the error
RecordedRun read_run(std::vector<std::byte> bytes, const std::string& name,
                     const char* consequence = "Nothing was replayed");

}  // namespace collided::client
