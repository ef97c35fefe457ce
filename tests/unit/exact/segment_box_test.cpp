// A35: a segment against an axis-aligned box, three axes of faces and three cross products. On a lattice everything
// touches all the time, cross products vanish and segments have no length; clipping in whole numbers knows the answer.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::segment_box_test {
namespace {

using Whole = std::int64_t;
using WholeVector = std::array<Whole, 3>;

struct Question {
  WholeVector from, to;   // of the segment
  WholeVector low, high;  // of the box
};

/// A quotient of whole numbers; the denominator is positive.
struct Quotient {
  Whole above;
  Whole below;
  friend bool operator<(const Quotient& p, const Quotient& q) { return p.above * q.below < q.above * p.below; }
};

/// Liang and Barsky: what is left of [0, 1] between the planes of all three axes.
bool meets_by_clipping(const Question& q) {
  Quotient first{0, 1};
  Quotient last{1, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Whole step = q.to[axis] - q.from[axis];
    if (step == 0) {
      if (q.from[axis] < q.low[axis] || q.from[axis] > q.high[axis]) return false;
      continue;
    }
    const Whole nearer = step > 0 ? q.low[axis] - q.from[axis] : q.from[axis] - q.high[axis];
    const Whole farther = step > 0 ? q.high[axis] - q.from[axis] : q.from[axis] - q.low[axis];
    const Whole size = std::abs(step);
    if (first < Quotient{nearer, size}) first = {nearer, size};
    if (Quotient{farther, size} < last) last = {farther, size};
  }
  return !(last < first);
}

Vec3 vec(const WholeVector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Question random_question(std::mt19937_64& random) {
  const auto number = [&](Whole most) { return static_cast<Whole>(random() % static_cast<std::uint64_t>(most)); };
  Question q;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    q.from[axis] = number(13) - 6;
    q.to[axis] = random() % 3 == 0 ? q.from[axis] : number(13) - 6;
    q.low[axis] = number(6) - 5;
    q.high[axis] = q.low[axis] + number(9);
  }
  return q;
}

TEST(ExactSegmentBox, IsWhatClippingInWholeNumbersSays) {
  const char* asked = std::getenv("COLLIDED_SEGMENTS");
  const long count = asked != nullptr ? std::atol(asked) : 100'000;
  std::mt19937_64 random = oracle::seeded(35);
  long yes = 0;
  long points = 0;
  long along_axes = 0;
  for (long i = 0; i < count; ++i) {
    const Question q = random_question(random);
    const Box box{(vec(q.low) + vec(q.high)) / 2, Mat3::Identity(), (vec(q.high) - vec(q.low)) / 2};
    const bool truth = meets_by_clipping(q);
    ASSERT_EQ(overlaps(box, Capsule{vec(q.from), vec(q.to), 0}).decision, truth ? Decision::yes : Decision::no) << i;
    yes += truth ? 1 : 0;
    int steps = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) steps += q.from[axis] != q.to[axis] ? 1 : 0;
    along_axes += steps == 1 ? 1 : 0;
    if (steps > 0) continue;
    ++points;
    ASSERT_EQ(overlaps(box, Sphere{vec(q.from), 0}).yes(), truth) << "no length is a point, " << i;
  }
  EXPECT_GT(yes, count / 10);
  EXPECT_LT(yes, 9 * count / 10);
  EXPECT_GT(points, count / 100);
  EXPECT_GT(along_axes, count / 100) << "cross products that vanish";
}

}  // namespace
}  // namespace collided::engine::segment_box_test
