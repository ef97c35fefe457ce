#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "collided/codes.hpp"

namespace collided::wire_contract {

/// The instant that a question is about: `instant` and `instant_ns` in a Query; in commands a text: "" for latest,
/// "settled", "1795348990000000000" (ns since 1970), or "-2000000000" (ns before the server's newest instant).
struct AskedInstant {
  using Kind = codes::InstantKind;
  Kind kind = Kind::latest;
  std::int64_t ns = 0;  // for `at` and `back`, not negative

  friend bool operator==(const AskedInstant&, const AskedInstant&) = default;
};

/// Writes the instant as text for a command.
inline std::string text_of(const AskedInstant& instant) {
  switch (instant.kind) {
    case AskedInstant::Kind::latest: return {};
    case AskedInstant::Kind::settled: return "settled";
    case AskedInstant::Kind::at: return std::to_string(instant.ns);
    case AskedInstant::Kind::back: break;
  }
  return "-" + std::to_string(instant.ns);
}

/// Reads the instant from a command's text; nothing if the text is invalid.
inline std::optional<AskedInstant> asked_instant(std::string_view text) {
  if (text.empty()) return AskedInstant{};
  if (text == "settled") return AskedInstant{.kind = AskedInstant::Kind::settled};
  AskedInstant instant{.kind = text.front() == '-' ? AskedInstant::Kind::back : AskedInstant::Kind::at};
  if (instant.kind == AskedInstant::Kind::back) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), instant.ns);
  if (error != std::errc{} || end != text.data() + text.size() || text.front() == '-') return std::nullopt;
  return instant;
}

}  // namespace collided::wire_contract
