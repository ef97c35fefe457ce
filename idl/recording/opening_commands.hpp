#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Which commands an opening has taken into account, as the metadata of a recording have it. Whoever has heard the same
/// commands meanwhile leaves them out: they would be carried out twice.
namespace collided::recording {

/// A command by its client and the client's number for it.
using CommandNumber = std::pair<std::uint64_t, std::uint64_t>;

inline constexpr const char* kOpeningCommands = "opening_commands";

/// "4f:1 4f:2", hexadecimal.
std::string text_of(std::span<const CommandNumber> commands);
/// Reads that from text of unknown origin, up to where it is something else.
std::vector<CommandNumber> command_numbers(std::string_view text);

}  // namespace collided::recording
