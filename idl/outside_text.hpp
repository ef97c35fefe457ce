#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Text from outside: its form in messages, and its maximum nesting.
namespace collided::wire_contract {

/// Bytes of the printable character at the start of a non-empty text; 0 for a control character, and for bytes that are
/// not UTF-8.
std::size_t printable_length(std::string_view text);

/// The text for use in a message, at most about 80 bytes: '?' replaces unprintable bytes, and "..." the rest.
std::string shown(std::string_view text);
/// shown() in quotes.
std::string in_quotes(std::string_view text);

/// Deeper JSON is refused: code that writes or copies it recurses once per level, and would overflow the stack.
inline constexpr std::size_t kMostJsonDepth = 64;
bool nests_too_deep(std::string_view json);

}  // namespace collided::wire_contract
