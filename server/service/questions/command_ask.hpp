#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/service/questions/participants.hpp"

namespace collided::engine::service {

/// A command as received; see idl/commands.hpp.
struct CommandAsk {
  std::uint64_t client = 0;
  std::uint64_t request = 0;
  std::string text;
  std::vector<std::byte> blob;  // a Shape of scene.fbs, or empty
  // The sender; a repeated command was allowed when it first came.
  QuerySender from{.participant = 0, .peer = nullptr, .rights = 0xff};

  /// Whether an earlier process had carried it out; the request is then its position among the commands left by that
  /// process.
  bool is_carried_out_again() const { return client == 0 && request != 0; }
};

}  // namespace collided::engine::service
