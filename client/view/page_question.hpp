#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "collided/client.hpp"

namespace collided::view {

/// A question about two objects.
struct PairOfNames {
  std::string a;
  std::string b;
};

/// An object, in full.
struct ObjectOfName {
  std::string name;
};

/// Which publisher moves what.
struct Owners {};

/// A question of the page: {"ask": "ray", "id", "origin": [3], "direction": [3]}, {"ask": "pair", "id", "a", "b"},
/// {"ask": "object", "id", "name"} or {"ask": "owners", "id"}.
struct PageQuestion {
  double id = 0;  // the page's number for it, repeated in the answer
  std::variant<RayQuestion, PairOfNames, ObjectOfName, Owners> what;
};

/// Reads a question from untrusted text. Nothing where it is not JSON, a member is missing or of another type, a number
/// is not finite, the direction is zero, or a name is empty or longer than 255 bytes.
std::optional<PageQuestion> parse_page_question(std::string_view text);

}  // namespace collided::view
