#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "collided/client.hpp"

namespace collided::view {

struct PairOfNames {
  std::string a;
  std::string b;
};

/// What the page asks: {"ask": "ray", "id", "origin": [3], "direction": [3]} or {"ask": "pair", "id", "a", "b"}.
struct PageQuestion {
  double id = 0;  // comes back with the answer
  std::variant<RayQuestion, PairOfNames> what;
};

/// From bytes of anybody; nothing where they are no question: not JSON, a member missing or of another kind, a number that
/// is not finite, a direction without length, a name that is empty or longer than 255 bytes.
std::optional<PageQuestion> parse_page_question(std::string_view text);

}  // namespace collided::view
