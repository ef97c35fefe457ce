#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Text from outside: how messages show it, and how deep it may nest.
namespace collided::wire_contract {

/// Bytes of the printable character at the start of a text that is not empty; 0 for a control character, and for bytes
/// that are not UTF-8.
std::size_t printable_length(std::string_view text);

/// The text as a message shows it, at most about 80 bytes: '?' stands for what is not printable, and "..." for the rest.
std::string shown(std::string_view text);
/// shown() in quotes.
std::string in_quotes(std::string_view text);

/// Deeper JSON is refused: what writes or copies it calls itself once a level, and would end the process.
inline constexpr std::size_t kMostJsonDepth = 64;
bool nests_too_deep(std::string_view json);

}  // namespace collided::wire_contract
