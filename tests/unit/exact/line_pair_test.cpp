// A41: two lines cross, are skew, parallel or collinear, by name and never as NaN; and the engine's segments, long enough
// to hold the lines' nearest points, know the same places and distances.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/part.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/line_pair.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::line_pair_test {
namespace {

using oracle::line_pair;
using oracle::LineCase;
using oracle::LinePair;
using oracle::Rational;
using In2 = oracle::Point2<double>;

template <class To, std::size_t kSize>
std::array<To, kSize> as(const std::array<int, kSize>& whole) {
  std::array<To, kSize> other;
  for (std::size_t i = 0; i < kSize; ++i) other[i] = To(whole[i]);
  return other;
}

/// Two lines of small whole numbers; many of their directions are multiples of each other, or across.
template <std::size_t kSize>
struct Lines {
  using Whole = std::array<int, kSize>;
  Whole o1{}, d1{}, o2{}, d2{};

  explicit Lines(std::mt19937_64& random) {
    const auto draw = [&](Whole& v) {
      for (int& number : v) number = static_cast<int>(random() % 9) - 4;
    };
    draw(o1), draw(o2);
    do draw(d1);
    while (d1 == Whole{});
    do draw(d2);
    while (d2 == Whole{});
    const int factor = random() % 2 == 0 ? 2 : -3;
    if (random() % 3 != 0) return;
    for (std::size_t i = 0; i < kSize; ++i) d2[i] = factor * d1[i];
    if (random() % 2 != 0) return;
    for (std::size_t i = 0; i < kSize; ++i) o2[i] = o1[i] + factor * d1[i];
  }
  template <class Number>
  LinePair<Number> pair() const {
    return line_pair<Number>(as<Number>(o1), as<Number>(d1), as<Number>(o2), as<Number>(d2));
  }
};

void expect_near(double value, const Rational& truth) {
  const auto exact = static_cast<double>(truth);
  ASSERT_LE(std::abs(value - exact), 1e-12 * std::max(1.0, std::abs(exact)));
}

TEST(ExactLinePair, InThePlaneLinesCrossOrAreParallelOrCollinearByName) {
  std::mt19937_64 random = oracle::seeded(41);
  std::map<LineCase, int> seen;
  for (int i = 0; i < 100'000; ++i) {
    const Lines<2> lines(random);
    const LinePair<double> plain = lines.pair<double>();
    ASSERT_TRUE(std::isfinite(plain.s) && std::isfinite(plain.t));
    ++seen[plain.kind];
    if (plain.kind != LineCase::crossing) continue;
    // Both ways lead to one point.
    for (std::size_t axis = 0; axis < 2; ++axis) {
      ASSERT_NEAR(lines.o1[axis] + plain.s * lines.d1[axis], lines.o2[axis] + plain.t * lines.d2[axis], 1e-12);
    }
  }
  EXPECT_GT(seen[LineCase::crossing], 1000);
  EXPECT_GT(seen[LineCase::parallel], 1000);
  EXPECT_GT(seen[LineCase::collinear], 1000);
  EXPECT_EQ(seen.size(), 3u);
}

// Perpendicular lines: a dot product in the place of the perp dot product would divide by zero here.
TEST(ExactLinePair, LinesAcrossEachOtherCross) {
  const LinePair<double> pair = line_pair(In2{0, 3}, In2{2, 0}, In2{4, 0}, In2{0, 1});
  EXPECT_EQ(pair.kind, LineCase::crossing);
  EXPECT_EQ(pair.s, 2);
  EXPECT_EQ(pair.t, 3);
}

Vec3 vec(const std::array<int, 3>& v) { return {double(v[0]), double(v[1]), double(v[2])}; }

/// What the engine says of segments of the lines about those places.
void expect_segments_agree(const Lines<3>& lines, const LinePair<Rational>& truth) {
  const Vec3 d1 = vec(lines.d1), d2 = vec(lines.d2);
  // Whole parameters, so that the segments lie on the lines to the bit.
  const double s = std::floor(static_cast<double>(truth.s)), t = std::floor(static_cast<double>(truth.t));
  const Capsule one{vec(lines.o1) + (s - 2) * d1, vec(lines.o1) + (s + 3) * d1, 0};
  const Capsule other{vec(lines.o2) + (t - 2) * d2, vec(lines.o2) + (t + 3) * d2, 0};
  ASSERT_EQ(overlaps(one, other).yes(), truth.kind == LineCase::crossing);
  if (truth.kind == LineCase::crossing) return;
  const Separation apart = separation(ConvexPart(Primitive(one)), ConvexPart(Primitive(other)));
  const Vec3 foot1 = vec(lines.o1) + static_cast<double>(truth.s) * d1;
  const Vec3 foot2 = vec(lines.o2) + static_cast<double>(truth.t) * d2;
  ASSERT_NEAR(apart.distance_m, (foot2 - foot1).norm(), apart.error_m + 1e-12);
  ASSERT_LT(apart.error_m, 1e-9);
  ASSERT_LE((apart.on_a - foot1).norm(), apart.point_error_m + 1e-12);
  ASSERT_LE((apart.on_b - foot2).norm(), apart.point_error_m + 1e-12);
}

TEST(ExactLinePair, InSpaceTheNearestPointsLieAcrossBothLines) {
  std::mt19937_64 random = oracle::seeded(42);
  std::map<LineCase, int> seen;
  for (int i = 0; i < 20'000; ++i) {
    const Lines<3> lines(random);
    const LinePair<Rational> truth = lines.pair<Rational>();
    const LinePair<double> plain = lines.pair<double>();
    ASSERT_EQ(plain.kind, truth.kind) << i;
    ++seen[truth.kind];
    expect_near(plain.s, truth.s);
    expect_near(plain.t, truth.t);
    if (truth.kind == LineCase::parallel || truth.kind == LineCase::collinear) continue;
    oracle::Point3<Rational> between;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      between[axis] = lines.o2[axis] + truth.t * lines.d2[axis] - lines.o1[axis] - truth.s * lines.d1[axis];
    }
    ASSERT_EQ(oracle::dot<Rational>(between, as<Rational>(lines.d1)), 0) << i;
    ASSERT_EQ(oracle::dot<Rational>(between, as<Rational>(lines.d2)), 0) << i;
    expect_segments_agree(lines, truth);
    if (HasFatalFailure()) FAIL() << i;
  }
  EXPECT_GT(seen[LineCase::skew], 1000);
  EXPECT_GT(seen[LineCase::crossing], 100);
  EXPECT_GT(seen[LineCase::parallel], 1000);
  EXPECT_GT(seen[LineCase::collinear], 1000);
}

}  // namespace
}  // namespace collided::engine::line_pair_test
