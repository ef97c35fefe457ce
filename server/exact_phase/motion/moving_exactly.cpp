#include "server/exact_phase/motion/moving_exactly.hpp"

#include <algorithm>

#include "server/exact_phase/motion/algebraic_time.hpp"

namespace collided::engine::kernel {
namespace {

struct MovingPair {
  Sides<Dyadic> sides;
  Gaps<Dyadic> gaps;

  bool meets_at(AlgebraicTime& time) const {
    return meets_in_plane(sides, gaps, [&](const TimePolynomial& p) { return time.sign_of(p); }) == Decision::yes;
  }
};

/// While the points stay in one plane, contact can begin only when a turn or a gap changes its sign.
std::vector<AlgebraicTime> changes_in_plane(const MovingPair& question, const Dyadic& from) {
  std::vector<AlgebraicTime> times;
  const auto add = [&](const Path<Dyadic>& v) {
    for (int axis = 0; axis < 3; ++axis) {
      for (AlgebraicTime& root : roots_between(component(v, axis), from, Dyadic(1))) times.push_back(std::move(root));
    }
  };
  for (int i = 0; i < question.sides.group_count * question.sides.group_size; ++i) add(question.sides.turn[i]);
  for (int i = 0; i < question.gaps.count; ++i) add(question.gaps.gap[i]);
  return times;
}

/// The first of several times at which there is contact.
Decision first_of(std::vector<AlgebraicTime>& times, const MovingPair& question, double width, TimeBracket& bracket) {
  for (AlgebraicTime& time : times) time.narrow(width);
  const auto earlier = [](const AlgebraicTime& a, const AlgebraicTime& b) {
    return sign(a.low() - b.low()) == Sign::negative;
  };
  std::sort(times.begin(), times.end(), earlier);
  bool found = false;
  for (AlgebraicTime& time : times) {
    const TimeBracket own = time.bracket();
    // Brackets may overlap, so an earlier low end does not imply an earlier root.
    if (found && own.low >= bracket.high) break;
    if (!question.meets_at(time)) continue;
    bracket = found ? TimeBracket{std::min(bracket.low, own.low), std::min(bracket.high, own.high)} : own;
    found = true;
  }
  return found ? Decision::yes : Decision::no;
}

}  // namespace

Decision first_contact_exactly(const Quartet& q, double from, double width, TimeBracket& bracket) {
  const MovingQuartet<Dyadic> moving(q);
  TimePolynomial coplanarity = moving.coplanarity();
  coplanarity.trim();
  const MovingPair question{Sides<Dyadic>(moving), Gaps<Dyadic>(moving)};
  const Dyadic begin(from);
  if (coplanarity.count() > 0) {
    auto times = roots_between(coplanarity, begin, Dyadic(1));
    return first_of(times, question, width, bracket);
  }
  AlgebraicTime start(begin);
  if (question.meets_at(start)) {
    bracket = start.bracket();
    return Decision::yes;
  }
  auto times = changes_in_plane(question, begin);
  return first_of(times, question, width, bracket);
}

}  // namespace collided::engine::kernel
