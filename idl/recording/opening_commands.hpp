#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The commands with effects that an opening already includes, in the metadata of a recording. A recorder or replay that
/// has also received these commands leaves them out, since they would be executed twice.
namespace collided::recording {

/// A command by its client and the client's number for it.
using CommandNumber = std::pair<std::uint64_t, std::uint64_t>;

inline constexpr const char* kOpeningCommands = "opening_commands";

/// "4f:1 4f:2", hexadecimal.
std::string text_of(std::span<const CommandNumber> commands);
/// Reads such text from an unknown source, up to the first mismatch.
std::vector<CommandNumber> command_numbers(std::string_view text);

}  // namespace collided::recording
