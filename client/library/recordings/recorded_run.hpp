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

/// A state of the recorded server: the newest applied message of each publisher.
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
  std::uint64_t publisher = 0;  // 0: a sample of another topic
  std::uint64_t incarnation = 0;
  std::int64_t stamp_ns = 0;  // time of the poses by the publisher's clock; 0: none
};

/// A command that the server executed.
struct RecordedCommand {
  std::size_t query = 0;  // index of its item
  std::string answer;     // JSON; empty: not recorded, as for the opening
};

/// A recording, sorted for replay.
struct RecordedRun : RecordedItems {
  std::vector<RecordedOrigin> origins;  // by item
  std::map<StateNumber, RecordedState> states;
  std::map<StateNumber, std::vector<RecordedRequest>>
      requests;  // questions about the world, by the state they were about
  std::map<StateNumber, std::vector<std::size_t>>
      commands;  // indexes of items that changed the world, by the resulting state: queries and farewells
  /// Commands that changed the world, including those that load and clear scenes, by the index of the item at which
  /// they took effect: the last reply, or the command itself if it needs none.
  std::map<std::size_t, RecordedCommand> carried_out;
  std::map<std::uint64_t, std::uint64_t> opening_through;  // newest message of each publisher in the opening
  std::uint64_t unanswered = 0;                            // requests without all of their replies
  std::uint64_t changing_files = 0;                        // number of load and clear commands, which are not replayed
  std::string scenes;                                      // names, one per line, from the newest status
};

/// True if the reply announces that its client has disconnected with its standing questions; it answers no request.
bool is_farewell(const wire::Reply& reply);

/// Reads a recording for replay. Throws std::runtime_error with the path and the reason if nothing can be replayed.
RecordedRun read_run(const std::string& path);
/// Reads the bytes of a recording.
///
/// name         of the recording, for errors and warnings
/// consequence  what the failure means, as the end of the error
RecordedRun read_run(std::vector<std::byte> bytes, const std::string& name,
                     const char* consequence = "Nothing was replayed");

}  // namespace collided::client
