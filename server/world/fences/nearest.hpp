#pragma once

#include <string>

namespace collided::engine {

/// A question that stays: which object of a name is nearest to a point, or to the carrier of the definition of a fence
/// that has this rule.
struct NearestRule {
  double within_m = 0;      // what is farther away is not looked at
  double hysteresis_m = 0;  // another object takes the place of the nearest once it is nearer by more than this

  /// Beyond this distance the nearest is none any more, metres.
  double reach_m() const { return within_m + hysteresis_m; }
  bool operator==(const NearestRule&) const = default;
};

/// Why there cannot be such a rule; empty: there can.
std::string refusal_of(const NearestRule& rule);

}  // namespace collided::engine
