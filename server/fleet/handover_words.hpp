#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// How far a server has come with each publisher: its number, and the sequence number up to which all is in the world.
using PublisherProgress = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

/// What a server that hands over tells those that follow it.
struct HandoverWords {
  std::uint64_t to = 0;  // the server that takes its place
  PublisherProgress progress;
};

/// The command take_over of idl/commands.hpp.
std::string handover_text(const HandoverWords& words);
/// Nothing: the text is another command.
std::optional<HandoverWords> read_handover(std::string_view text);

}  // namespace collided::engine::service
