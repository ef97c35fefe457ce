#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/accuracy/bound_truth.hpp"
#include "tests/accuracy/census/ray_inputs.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::census {
using namespace engine;
namespace {

/// U1: no error beyond its bound, of all cases. COLLIDED_CASES asks for more than the default run's few.
int case_count() {
  const char* asked = std::getenv("COLLIDED_CASES");
  return asked != nullptr ? std::atoi(asked) : 6000;
}

/// Errors and bounds of one kind of number in one family, in steps of its grid.
class Record {
 public:
  static constexpr double kTightest = 16;

  Record(const char* what, Family family) : what_(what), family_(family) {}
  ~Record() {
    if (bounds_.empty()) return;
    const auto middle = bounds_.begin() + static_cast<std::ptrdiff_t>(bounds_.size() / 2);
    std::nth_element(bounds_.begin(), middle, bounds_.end());
    std::printf("%-22s %-9s %9zu numbers, largest error %.3g, median bound %.3g, largest error/bound %.3f\n", what_,
                name(family_), bounds_.size(), largest_error_, *middle, largest_ratio_);
    // Of a few numbers the largest error says little.
    if (bounds_.size() < 5000) return;
    EXPECT_LE(*middle, kTightest * largest_error_)
        << what_ << " " << name(family_) << ": a bound so wide proves little";
  }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// The truth in steps of the grid, the answer in metres; false when the error exceeds the bound.
  bool add(Quad truth, double answer_m, double bound_m, const Placing& at) {
    const double step = std::ldexp(1.0, -at.power);
    const Quad off = static_cast<Quad>(answer_m) * static_cast<Quad>(step) - truth;
    return add_error(static_cast<double>(off < 0 ? -off : off), bound_m * step);
  }
  bool add_error(double error, double bound) {
    bounds_.push_back(bound);
    largest_error_ = std::max(largest_error_, error);
    if (error > 0) largest_ratio_ = std::max(largest_ratio_, error / bound);
    // The truth itself is good to 2^-100 of the grid's extent, 2^24 steps.
    return error <= bound * (1 + 1e-12) + 0x1p-76;
  }

 private:
  const char* what_;
  Family family_;
  std::vector<double> bounds_;
  double largest_error_ = 0;
  double largest_ratio_ = 0;
};

/// Scaled by powers that a double survives with all its digits.
Placing place_of(Maker& make) {
  Placing at = make.placing();
  at.power = std::clamp(at.power, -300, 300);
  return at;
}

double point_error(const Vec3& found, const std::array<Quad, 3>& truth, const Placing& at) {
  Quad sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Quad off = static_cast<Quad>(found[k]) * static_cast<Quad>(std::ldexp(1.0, -at.power)) -
                     (truth[k] + static_cast<Quad>(at.offset[k]));
    sum += off * off;
  }
  return static_cast<double>(root(sum));
}

template <class MakeCase>
void check_rays(const char* what, std::uint64_t seed, MakeCase make_case) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : {Family::random, Family::touching, Family::needle, Family::far}) {
    Maker make(generator, family);
    Record distances(what, family);
    Record points("  its point", family);
    for (int i = 0; i < case_count(); ++i) {
      const auto input = make_case(make);
      const RayInput& ray = input.first;
      const Placing at = place_of(make);
      RayHit hit;
      if (cast_ray(placed(ray, at), placed(input.second, at), hit).decision != Decision::yes) continue;
      const std::optional<Quad> s = first_parameter(ray, input.second);
      ASSERT_TRUE(s) << what << name(family) << i;
      ASSERT_TRUE(distances.add(*s * length_quad(ray.direction), hit.distance_m, hit.distance_error_m, at))
          << what << " " << name(family) << " " << i << " " << hit.distance_m << " +- " << hit.distance_error_m;
      std::array<Quad, 3> truth;
      for (std::size_t k = 0; k < 3; ++k)
        truth[k] = static_cast<Quad>(ray.origin[k]) + *s * static_cast<Quad>(ray.direction[k]);
      ASSERT_TRUE(points.add_error(point_error(hit.point, truth, at), std::ldexp(point_error_m(hit), -at.power)))
          << what << " " << name(family) << " " << i << " point";
    }
  }
}

TEST(AccuracyBounds, RayTriangle) { check_rays("ray triangle", 1, triangle_case); }
TEST(AccuracyBounds, RaySphere) { check_rays("ray sphere", 2, ball_case); }
TEST(AccuracyBounds, RayBox) { check_rays("ray box", 3, box_case); }
TEST(AccuracyBounds, RayCapsule) { check_rays("ray capsule", 4, pill_case); }

std::int64_t radius_of(const BallInput& b) { return b.radius; }
std::int64_t radius_of(const PillInput& c) { return c.radius; }
std::int64_t radius_of(const BoxInput&) { return 0; }
std::int64_t radius_of(const TriangleInput&) { return 0; }

template <class MakeCase>
void check_closest(const char* what, std::uint64_t seed, MakeCase make_case) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : {Family::random, Family::touching, Family::needle, Family::far}) {
    Maker make(generator, family);
    Record distances(what, family);
    for (int i = 0; i < case_count(); ++i) {
      const auto [ball, shape] = make_case(make);
      const Placing at = place_of(make);
      const Closest found = closest(at.point(ball.center), placed(shape, at));
      const Quad truth = std::max(Quad(0), -excess(core_distance2(ball.center, shape), radius_of(shape)));
      ASSERT_TRUE(distances.add(truth, found.distance_m, found.distance_error_m, at))
          << what << " " << name(family) << " " << i << " " << found.distance_m << " +- " << found.distance_error_m;
      // A point of the set at the reported distance: both known to the sum of the bounds.
      const double apart = (found.point - at.point(ball.center)).stableNorm();
      EXPECT_LE(std::abs(apart - found.distance_m),
                found.point_error_m + found.distance_error_m + 4 * kRoundoff * apart);
    }
  }
}

TEST(AccuracyBounds, ClosestSphere) { check_closest("closest sphere", 11, ball_ball); }
TEST(AccuracyBounds, ClosestBox) { check_closest("closest box", 12, ball_box); }
TEST(AccuracyBounds, ClosestCapsule) { check_closest("closest capsule", 13, ball_pill); }
TEST(AccuracyBounds, ClosestTriangle) { check_closest("closest triangle", 14, ball_triangle); }

Quad depth(const BallInput& a, const BallInput& b) { return excess(core_distance2(a.center, b), a.radius + b.radius); }
Quad depth(const BallInput& a, const PillInput& b) { return excess(core_distance2(a.center, b), a.radius + b.radius); }
Quad depth(const BallInput& a, const TriangleInput& b) { return excess(core_distance2(a.center, b), a.radius); }
Quad depth(const BallInput& a, const BoxInput& b) {
  const Quad apart2 = core_distance2(a.center, b);
  if (apart2 > 0) return excess(apart2, a.radius);
  Polytope point{{finer<Wide>(a.center, b.shift)}, {}, {}};
  return static_cast<Quad>(a.radius) +
         least_push(point, polytope(b, b.shift)) / static_cast<Quad>(std::int64_t{1} << b.shift);
}
Quad depth(const PillInput& a, const PillInput& b) { return excess(core_distance2(a, b), a.radius + b.radius); }
Quad depth(const PillInput& a, const TriangleInput& b) { return excess(core_distance2(a, b), a.radius); }
Quad depth(const BoxInput& a, const BoxInput& b) { return least_push_of(a, b, std::max(a.shift, b.shift)); }
Quad depth(const BoxInput& a, const TriangleInput& b) { return least_push_of(a, b, a.shift); }
Quad depth(const TriangleInput& a, const TriangleInput& b) { return least_push_of(a, b, 0); }

template <class MakeCase>
void check_depths(const char* what, std::uint64_t seed, MakeCase make_case) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : {Family::random, Family::touching, Family::needle}) {
    Maker make(generator, family);
    Record depths(what, family);
    for (int i = 0; i < case_count(); ++i) {
      const auto [a, b] = make_case(make);
      const Placing at = place_of(make);
      const auto shape_a = placed(a, at);
      const auto shape_b = placed(b, at);
      if (!overlaps(shape_a, shape_b).yes()) continue;
      const Quad truth = depth(a, b);
      // Two capsules whose axes cross need a push along an axis that this truth does not look for.
      if constexpr (std::is_same_v<decltype(a), const PillInput>) {
        if (core_distance2(a, b) == 0) continue;
      }
      const Contact found = contact(shape_a, shape_b);
      ASSERT_TRUE(depths.add(truth, found.depth_m, found.depth_error_m, at))
          << what << " " << name(family) << " " << i << " " << found.depth_m << " +- " << found.depth_error_m
          << " truth " << static_cast<double>(truth);
    }
  }
}

TEST(AccuracyBounds, DepthSphereSphere) { check_depths("depth sphere sphere", 21, ball_ball); }
TEST(AccuracyBounds, DepthSphereBox) { check_depths("depth sphere box", 22, ball_box); }
TEST(AccuracyBounds, DepthSphereCapsule) { check_depths("depth sphere capsule", 23, ball_pill); }
TEST(AccuracyBounds, DepthSphereTriangle) { check_depths("depth sphere triangle", 24, ball_triangle); }
TEST(AccuracyBounds, DepthBoxBox) { check_depths("depth box box", 25, box_box); }
TEST(AccuracyBounds, DepthBoxTriangle) { check_depths("depth box triangle", 26, box_triangle); }
TEST(AccuracyBounds, DepthCapsuleCapsule) { check_depths("depth capsule capsule", 27, pill_pill); }
TEST(AccuracyBounds, DepthCapsuleTriangle) { check_depths("depth capsule triangle", 28, pill_triangle); }
TEST(AccuracyBounds, DepthTriangleTriangle) { check_depths("depth triangle triangle", 29, triangle_triangle); }

/// The centre's path is a ray of the length of one step; the two radii add up.
template <class Shape>
void check_times(const char* what, std::uint64_t seed, auto grown, auto make_shape) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : {Family::random, Family::touching, Family::needle}) {
    Maker make(generator, family);
    Record times(what, family);
    for (int i = 0; i < case_count() / 4; ++i) {
      const GridPoint start = make.point();
      const GridPoint end = make.point();
      const std::int64_t radius = make.size() / 4;
      const Shape shape = make_shape(make);
      if (start == end) continue;
      TimeBracket bracket;
      const MovingSphere mover{{double(start[0]), double(start[1]), double(start[2])},
                               {double(end[0]), double(end[1]), double(end[2])},
                               static_cast<double>(radius)};
      const bool found = first_contact(mover, placed(shape, Placing{}), 0, bracket).yes();
      const std::optional<Quad> truth = first_parameter(RayInput{start, end - start}, grown(shape, radius));
      ASSERT_EQ(found, truth && *truth <= 1) << what << name(family) << i;
      if (!found) continue;
      ASSERT_LE(static_cast<Quad>(bracket.low), *truth) << what << name(family) << i;
      ASSERT_GE(static_cast<Quad>(bracket.high), *truth) << what << name(family) << i;
      ASSERT_LE(bracket.high, std::nextafter(bracket.low, 2.0));
    }
  }
}

TEST(AccuracyBounds, TimeSphereSphere) {
  check_times<BallInput>(
      "time sphere sphere", 31,
      [](BallInput b, std::int64_t r) {
        b.radius += r;
        return b;
      },
      [](Maker& make) { return make.ball(); });
}
TEST(AccuracyBounds, TimeSphereCapsule) {
  check_times<PillInput>(
      "time sphere capsule", 32,
      [](PillInput c, std::int64_t r) {
        c.radius += r;
        return c;
      },
      [](Maker& make) { return make.pill(); });
}

}  // namespace
}  // namespace collided::census
