#include "idl/outside_text.hpp"

namespace collided::wire_contract {
namespace {

/// Length of the well-formed UTF-8 sequence at the start of the text; 0 if there is none.
///
/// source  The Unicode Standard, table 3-7
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return follows(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const unsigned low = lead == 0xE0 ? 0xA0 : 0x80;
    const unsigned high = lead == 0xED ? 0x9F : 0xBF;
    return follows(1, low, high) && follows(2) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const unsigned low = lead == 0xF0 ? 0x90 : 0x80;
    const unsigned high = lead == 0xF4 ? 0x8F : 0xBF;
    return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::size_t printable_length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const bool control = lead < 0x20 || lead == 0x7F;
  return control ? 0 : utf8_length(text);
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMostBytes = 79;
  std::string safe;
  while (!text.empty() && safe.size() < kMostBytes) {
    const std::size_t length = printable_length(text);
    safe += length == 0 ? std::string_view("?") : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return text.empty() ? safe : safe + "...";
}

std::string in_quotes(std::string_view text) { return '\'' + shown(text) + '\''; }

bool nests_too_deep(std::string_view json) {
  std::size_t depth = 0;
  bool is_in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (is_in_text && c == '\\') ++i;
    else if (c == '"') is_in_text = !is_in_text;
    else if (!is_in_text && (c == '[' || c == '{') && ++depth > kMostJsonDepth) return true;
    else if (!is_in_text && (c == ']' || c == '}') && depth > 0) --depth;
  }
  return false;
}

}  // namespace collided::wire_contract
