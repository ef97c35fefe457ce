#include "client/cli/output/top_keys.hpp"

namespace collided::cli {
namespace {

constexpr char kEscape = 27;
constexpr char kDelete = 127;
constexpr char kBackspace = 8;
constexpr std::size_t kMostFilterBytes = 255;

/// Removes the last character with all its bytes in UTF-8.
void drop_character(std::string& text) {
  const auto goes_on = [](char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; };
  while (!text.empty() && goes_on(text.back())) text.pop_back();
  if (!text.empty()) text.pop_back();
}

void type_filter(char key, TopChoice& choice) {
  if (key == '\n' || key == '\r') choice.is_typing = false;
  else if (key == kDelete || key == kBackspace) drop_character(choice.filter);
  else if (key == kEscape) {
    choice.is_typing = false;
    choice.filter.clear();
  } else if (static_cast<unsigned char>(key) >= ' ' && choice.filter.size() < kMostFilterBytes) {
    choice.filter += key;
  }
}

TopOrder order_after(TopOrder order) {
  switch (order) {
    case TopOrder::age: return TopOrder::rate;
    case TopOrder::rate: return TopOrder::name;
    case TopOrder::name: break;
  }
  return TopOrder::age;
}

}  // namespace

bool obey(char key, TopChoice& choice) {
  if (choice.is_typing) {
    type_filter(key, choice);
    return true;
  }
  switch (key) {
    case 'q':
    case 'Q': return false;
    case 's': choice.order = order_after(choice.order); break;
    case 'r': choice.is_reversed = !choice.is_reversed; break;
    case '/': choice.is_typing = true; break;
    case ' ': choice.is_paused = !choice.is_paused; break;
    case kEscape: choice.filter.clear(); break;
    default: break;
  }
  return true;
}

}  // namespace collided::cli
