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

/// A state of the recorded server: which samples of each publisher were in it.
struct RecordedState {
  std::map<std::uint64_t, std::uint64_t> applied;  // by publisher
  std::set<std::uint64_t> lost;
};
using StateNumber = std::pair<std::uint64_t, std::uint64_t>;  // epoch, version

/// One request and what was answered.
struct RecordedRequest {
  std::vector<std::size_t> questions;  // items, by chunk
  std::vector<std::size_t> replies;
};

/// A recording sorted for who goes through it again.
struct RecordedRun : RecordedItems {
  std::map<StateNumber, RecordedState> states;
  std::map<StateNumber, std::vector<RecordedRequest>> requests;  // about the world, by the state that was asked
  std::map<StateNumber, std::vector<std::size_t>> commands;      // items that changed the world, by the state they made
  std::map<std::uint64_t, std::uint64_t> opening_through;        // newest sample of each publisher in the opening
  std::uint64_t unanswered = 0;                                  // requests without all of their replies
  std::uint64_t changing_files = 0;                              // load and clear, which are not given again
  std::string scenes;                                            // one a line, as the newest status had them
};

/// Throws std::runtime_error with the path and what is wrong where nothing can be replayed.
RecordedRun read_run(const std::string& path);
/// The same of bytes from anywhere; `name` for the sentences.
RecordedRun read_run(std::vector<std::byte> bytes, const std::string& name);

}  // namespace collided::client
