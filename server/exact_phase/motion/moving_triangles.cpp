#include <algorithm>
#include <array>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine {
namespace {

struct MotionSpan {
  double low;
  double high;
};

MotionSpan reach(const MovingTriangle& t, int axis, Vec3 MovingPoint::*when) {
  const auto [low, high] = std::minmax({(t.a.*when)[axis], (t.b.*when)[axis], (t.c.*when)[axis]});
  return {low, high};
}

bool finite(const MovingTriangle& t) {
  return t.a.start.allFinite() && t.a.end.allFinite() && t.b.start.allFinite() && t.b.end.allFinite() &&
         t.c.start.allFinite() && t.c.end.allFinite();
}

/// Whether on some axis one triangle stays strictly above the other. Exact.
bool parted_by_axis(const MovingTriangle& a, const MovingTriangle& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const MotionSpan start_a = reach(a, axis, &MovingPoint::start);
    const MotionSpan start_b = reach(b, axis, &MovingPoint::start);
    const MotionSpan end_a = reach(a, axis, &MovingPoint::end);
    const MotionSpan end_b = reach(b, axis, &MovingPoint::end);
    if (start_a.high < start_b.low && end_a.high < end_b.low) return true;
    if (start_b.high < start_a.low && end_b.high < end_a.low) return true;
  }
  return false;
}

bool rests(const MovingPoint& p) { return p.start == p.end; }

/// True if the plane of a triangle at rest has the other one strictly on one side, at both ends and so throughout.
bool parted_by_plane(const MovingTriangle& resting, const MovingTriangle& other) {
  using namespace kernel;
  if (!rests(resting.a) || !rests(resting.b) || !rests(resting.c)) return false;
  const Vector<Bounded> origin(resting.a.start);
  const Vector<Bounded> normal =
      cross(Vector<Bounded>(resting.b.start) - origin, Vector<Bounded>(resting.c.start) - origin);
  const Sign first = sign(dot(normal, Vector<Bounded>(other.a.start) - origin));
  if (first != Sign::positive && first != Sign::negative) return false;
  for (const Vec3* p : {&other.b.start, &other.c.start, &other.a.end, &other.b.end, &other.c.end}) {
    if (sign(dot(normal, Vector<Bounded>(*p) - origin)) != first) return false;
  }
  return true;
}

/// The earliest of several first contacts.
struct Earliest {
  ExactResult verdict;
  TimeBracket bracket{0, 1};
  bool open = false;

  void add(const ExactResult& part, const TimeBracket& own) {
    verdict.level = std::max(verdict.level, part.level);
    open = open || part.decision == Decision::undecided;
    if (!part.yes()) return;
    bracket = verdict.yes() ? TimeBracket{std::min(bracket.low, own.low), std::min(bracket.high, own.high)} : own;
    verdict.decision = Decision::yes;
  }
};

}  // namespace

/// Separate triangles first meet with a corner of one on the other or with an edge on an edge.
ExactResult first_contact(const MovingTriangle& a, const MovingTriangle& b, double width, TimeBracket& bracket) {
  if (!finite(a) || !finite(b)) return {Decision::undecided, Level::filter};
  if (parted_by_axis(a, b)) return {Decision::no, Level::filter};
  if (parted_by_plane(a, b) || parted_by_plane(b, a)) return {Decision::no, Level::filter};
  const ExactResult at_start =
      overlaps(Triangle{a.a.start, a.b.start, a.c.start}, Triangle{b.a.start, b.b.start, b.c.start});
  if (at_start.yes()) {
    bracket = {0, 0};
    return at_start;
  }
  Earliest earliest{{Decision::no, at_start.level}, {0, 1}, at_start.decision == Decision::undecided};
  const std::array<MovingPoint, 3> corner_a{a.a, a.b, a.c};
  const std::array<MovingPoint, 3> corner_b{b.a, b.b, b.c};
  TimeBracket own;
  for (int i = 0; i < 3; ++i) {
    earliest.add(first_contact(corner_a[i], b, width, own), own);
    earliest.add(first_contact(corner_b[i], a, width, own), own);
    for (int j = 0; j < 3; ++j) {
      earliest.add(first_contact(MovingSegment{corner_a[i], corner_a[(i + 1) % 3]},
                                 MovingSegment{corner_b[j], corner_b[(j + 1) % 3]}, width, own),
                   own);
    }
  }
  if (earliest.verdict.yes()) {
    // There is contact by then; if a part is undecided, it may have begun earlier.
    bracket = {earliest.open ? 0 : earliest.bracket.low, earliest.bracket.high};
  } else if (earliest.open) {
    earliest.verdict.decision = Decision::undecided;
  }
  return earliest.verdict;
}

}  // namespace collided::engine
