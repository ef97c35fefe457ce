#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace collided::wire_contract {

/// Bytes of a sequence "ESC [ ... m" at the start of the text, which can only set colors; 0 if there is none.
inline std::size_t color_sequence_bytes(std::string_view text) {
  if (!text.starts_with("\x1b[")) return 0;
  const std::size_t end = text.find_first_not_of("0123456789;", 2);
  return end != std::string_view::npos && text[end] == 'm' ? end + 1 : 0;
}

/// Makes text from untrusted sources safe for a log or a terminal: every control character becomes '?', so that none
/// can move the cursor, erase lines or set the window's title. Line ends and tabs stay.
///
/// keeps_colors  keeps sequences that set colors, for text that this program has colored
inline std::string terminal_text(std::string_view text, bool keeps_colors = false) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text[0]);
    const std::size_t color = keeps_colors ? color_sequence_bytes(text) : 0;
    // U+0080 to U+009F are control characters too, and terminals execute them.
    const bool is_c1 = byte == 0xC2 && text.size() > 1 && (static_cast<unsigned char>(text[1]) & 0xE0) == 0x80;
    const bool is_control = (byte < ' ' && byte != '\n' && byte != '\t') || byte == 0x7F || is_c1;
    const std::size_t length = std::max<std::size_t>(color, is_c1 ? 2 : 1);
    if (is_control && color == 0) safe += '?';
    else safe += text.substr(0, length);
    text.remove_prefix(length);
  }
  return safe;
}

}  // namespace collided::wire_contract
