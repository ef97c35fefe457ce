#include "idl/recording/opening_commands.hpp"

#include <array>
#include <charconv>

namespace collided::recording {
namespace {

constexpr int kBase = 16;

void append(std::string& text, std::uint64_t number) {
  std::array<char, 16> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number, kBase).ptr);
}

/// Takes a number and the byte after it off the text; false if there is none.
bool take(std::string_view& text, std::uint64_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, kBase);
  if (error != std::errc()) return false;
  const auto taken = static_cast<std::size_t>(end - text.data());
  text.remove_prefix(taken < text.size() ? taken + 1 : taken);
  return true;
}

}  // namespace

std::string text_of(std::span<const CommandNumber> commands) {
  std::string text;
  for (const auto& [client, request] : commands) {
    if (!text.empty()) text += ' ';
    append(text, client);
    text += ':';
    append(text, request);
  }
  return text;
}

std::vector<CommandNumber> command_numbers(std::string_view text) {
  std::vector<CommandNumber> commands;
  CommandNumber next;
  while (take(text, next.first) && take(text, next.second)) commands.push_back(next);
  return commands;
}

}  // namespace collided::recording
