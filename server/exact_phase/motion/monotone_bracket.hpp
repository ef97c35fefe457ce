#pragma once

#include <algorithm>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/arithmetic/time_between.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine::kernel {

/// Brackets the first contact with a predicate that is false up to some time and true from then on: `touched_by(t)`, an
/// ExactResult. The bracket's ends are exact answers. `guess()`, called only if there is a contact after the start,
/// affects no decision.
template <class TouchedBy, class Guess>
ExactResult bracket_monotone(const TouchedBy& touched_by, const Guess& guess, double width, TimeBracket& bracket) {
  Level level = Level::filter;
  const auto ask = [&](double t) {
    const ExactResult v = touched_by(t);
    level = std::max(level, v.level);
    return v.decision;
  };
  const Decision ever = ask(1);
  if (ever != Decision::yes) return {ever, level};
  bracket = {0, 1};
  if (ask(0) == Decision::yes) {
    bracket.high = 0;
    return {Decision::yes, level};
  }
  // False if the thread's precision leaves a time undecided; then the bracket stays as wide as it is.
  const auto narrow = [&](double t) {
    if (!(t > bracket.low && t < bracket.high)) return true;
    const Decision touched_then = ask(t);
    if (touched_then == Decision::undecided) return false;
    (touched_then == Decision::yes ? bracket.high : bracket.low) = t;
    return true;
  };
  // Approaches the guess from both sides, in steps that grow until they contain the root.
  const double about = guess();
  double reach = std::max(width * 0.4375, 4 * kRoundoff * about);
  for (int step = 0; step < 4 && bracket.high - bracket.low > width; ++step, reach *= 64) {
    narrow(about - reach);
    narrow(about + reach);
  }
  // 64 halvings of the exponent and 53 of the mantissa end at neighbouring doubles.
  for (int step = 0; step < 128 && bracket.high - bracket.low > width; ++step) {
    const double t = time_between(bracket.low, bracket.high);
    if (!(t > bracket.low && t < bracket.high) || !narrow(t)) break;
  }
  return {Decision::yes, level};
}

}  // namespace collided::engine::kernel
