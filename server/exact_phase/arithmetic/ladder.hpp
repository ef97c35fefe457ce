#pragma once

#include <algorithm>

#include "server/exact_phase/arithmetic/value.hpp"

namespace collided::engine::kernel {

// A test is written once over the number types; a ladder selects which of them it may use.

/// All rungs from double upward, for answers to clients.
struct WholeLadder {
  template <class Kernel>
  static ExactResult climb(const Kernel& kernel) {
    return kernel::climb(kernel);
  }

  /// value<N>() from the first number type for which it is crisp.
  template <class Value>
  static auto sharpened(const Value& value) {
    auto quick = value.template operator()<Bounded>();
    if (crisp(quick)) return quick;
    ++rungs.sharpened;
    const RangeWatch range;
    auto traced = value.template operator()<Traced>();
    if (crisp(traced)) return traced;
    if (!range.was_left()) {
      auto slow = value.template operator()<Expansion>();
      if (crisp(slow)) return slow;
    }
    auto scaled = value.template operator()<Scaled>();
    if (crisp(scaled)) return scaled;
    return value.template operator()<Dyadic>();
  }
};

/// Rationals alone, for audits.
struct RationalsAlone {
  template <class Kernel>
  static ExactResult climb(const Kernel& kernel) {
    return {kernel.template operator()<Dyadic>(), Level::rational};
  }

  template <class Value>
  static auto sharpened(const Value& value) {
    return value.template operator()<Dyadic>();
  }
};

/// The disjunction of two tests, at the higher of their levels.
inline ExactResult joined(const ExactResult& a, const ExactResult& b) {
  return {either(a.decision, b.decision), std::max(a.level, b.level)};
}

}  // namespace collided::engine::kernel
