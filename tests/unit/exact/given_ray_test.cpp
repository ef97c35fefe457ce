// Rays against shapes with a pose: decided for the shape and the pose as given, where double has placed it up to a rounding
// elsewhere. The truth is worked out by rationals, in the shape's own frame.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/given_ray.hpp"
#include "server/geometry/placing_error.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::given_ray_test {
namespace {

using Exact = std::array<mpq_class, 3>;

Exact exact(const Vec3& v) { return {mpq_class(v[0]), mpq_class(v[1]), mpq_class(v[2])}; }
Exact operator-(const Exact& a, const Exact& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
mpq_class dot(const Exact& a, const Exact& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Exact cross(const Exact& a, const Exact& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// q* v q / |q|^2
Exact turned_back(const Quat& q, const Exact& v) {
  const Exact u{mpq_class(-q.x()), mpq_class(-q.y()), mpq_class(-q.z())};
  const mpq_class w(q.w());
  const mpq_class norm2 = w * w + dot(u, u);
  const Exact across = cross(u, v);
  const mpq_class along = dot(u, v);
  Exact result;
  for (int i = 0; i < 3; ++i) result[i] = ((w * w - dot(u, u)) * v[i] + 2 * along * u[i] + 2 * w * across[i]) / norm2;
  return result;
}

/// A ray in the frame of a shape.
struct OwnRay {
  Exact origin;
  Exact direction;

  OwnRay(const Ray& ray, const Pose& pose)
      : origin(turned_back(pose.rotation, exact(ray.origin) - exact(pose.position))),
        direction(turned_back(pose.rotation, exact(ray.direction))) {}
};

/// Where a ray without end is in a shape: from one multiple of its direction to another; nothing where it misses it.
struct Stretch {
  mpq_class from;
  mpq_class to;
  bool is_inside = false;  // at the start
};

std::optional<Stretch> stretch_in(const OwnRay& ray, const Box& box) {
  std::optional<mpq_class> first;
  std::optional<mpq_class> last;
  for (int axis = 0; axis < 3; ++axis) {
    const mpq_class at = ray.origin[axis] - mpq_class(box.center[axis]);
    const mpq_class half(box.half_m[axis]);
    const mpq_class& speed = ray.direction[axis];
    if (speed == 0) {
      if (abs(at) > half) return std::nullopt;
      continue;
    }
    mpq_class a = (-half - at) / speed;
    mpq_class b = (half - at) / speed;
    if (a > b) std::swap(a, b);
    if (!first || a > *first) first = a;
    if (!last || b < *last) last = b;
  }
  if (*first > *last || *last < 0) return std::nullopt;
  return Stretch{*first < 0 ? mpq_class(0) : *first, *last, *first <= 0};
}

/// For a ray that is not parallel to the triangle.
std::optional<Stretch> stretch_in(const OwnRay& ray, const Triangle& t) {
  const Exact a = exact(t.a) - ray.origin;
  const Exact b = exact(t.b) - ray.origin;
  const Exact c = exact(t.c) - ray.origin;
  const Exact normal = cross(b - a, c - a);
  const mpq_class slope = dot(normal, ray.direction);
  if (slope == 0) return std::nullopt;
  const mpq_class sides[3] = {dot(ray.direction, cross(a, b)), dot(ray.direction, cross(b, c)),
                              dot(ray.direction, cross(c, a))};
  const bool is_met = std::all_of(sides, sides + 3, [](const mpq_class& side) { return side >= 0; }) ||
                      std::all_of(sides, sides + 3, [](const mpq_class& side) { return side <= 0; });
  const mpq_class at = dot(normal, a) / slope;
  if (!is_met || at < 0) return std::nullopt;
  return Stretch{at, at};
}

bool meets(const OwnRay& ray, const Sphere& ball) {
  const Exact to = exact(ball.center) - ray.origin;
  const mpq_class r2 = mpq_class(ball.radius_m) * mpq_class(ball.radius_m);
  if (dot(to, to) <= r2) return true;
  const Exact across = cross(to, ray.direction);
  return dot(to, ray.direction) > 0 && dot(across, across) <= r2 * dot(ray.direction, ray.direction);
}

class GivenRay : public testing::Test {
 protected:
  double unit() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector(double size) { return size * Vec3(unit(), unit(), unit()); }
  Pose pose() {
    const double far_m = std::pow(10, 3 * std::abs(unit()));
    return {.position = vector(far_m), .rotation = Quat(unit(), unit(), unit(), unit()).normalized()};
  }
  /// A neighbour of the point, or the point.
  Vec3 nudged(Vec3 point) {
    for (double& x : point) {
      if (unit() < 0) x = std::nextafter(x, unit() < 0 ? -1e300 : 1e300);
    }
    return point;
  }

  template <class Shape>
  ExactResult cast(const Ray& ray, const Shape& own, const Pose& pose, RayHit& hit) {
    const Frame frame = frame_of(pose);
    const Shape placed = place(frame, own);
    GivenPart given;
    given.pose = &pose;
    given.frame = &frame;
    Primitive primitive = Sphere{Vec3::Zero(), 0};
    if constexpr (std::is_same_v<Shape, Triangle>) {
      given.own = own;
    } else {
      primitive = own;
      given.own = &primitive;
    }
    const double off_m = given.placing_error_m(0);
    RayHit of_placed;
    const bool was_met = cast_ray(ray, placed, of_placed).yes();
    const ExactResult verdict = cast_ray_as_given(
        ray, placed, off_m, [&] { return given; }, hit);
    turned_ += was_met != verdict.yes() || (was_met && of_placed.inside != hit.inside) ? 1 : 0;
    if (verdict.yes() && hit.distance_m > 0) {
      const Triangle* corners = nullptr;
      if constexpr (std::is_same_v<Shape, Triangle>) corners = &placed;
      hit.distance_error_m += placing_error_along(ray, hit, off_m, corners);
    }
    return verdict;
  }

  /// Within the bound that answers report.
  void expect_distance(const Ray& ray, const RayHit& hit, const mpq_class& at) {
    if (!std::isfinite(hit.distance_error_m)) return;
    const mpq_class low = mpq_class(hit.distance_m) - mpq_class(hit.distance_error_m);
    const mpq_class high = mpq_class(hit.distance_m) + mpq_class(hit.distance_error_m);
    const Exact d = exact(ray.direction);
    const mpq_class square = at * at * dot(d, d);
    EXPECT_TRUE(low <= 0 || low * low <= square) << hit.distance_m << " +- " << hit.distance_error_m;
    EXPECT_TRUE(square <= high * high) << hit.distance_m << " +- " << hit.distance_error_m;
  }

  std::mt19937_64 random_ = oracle::seeded(481);
  int turned_ = 0;  // answers that are others for the shape as given than for the placed one
};

TEST_F(GivenRay, TrianglesAreMetWhereTheirCornersAreGiven) {
  for (int i = 0; i < 4'000; ++i) {
    const Triangle own{vector(1), vector(1), vector(1)};
    const Pose at = pose();
    const Triangle placed = place(frame_of(at), own);
    // At an edge, and from beside the plane or on it.
    const double share = 0.5 + unit() / 2;
    const Vec3 target = nudged(placed.a + share * (placed.b - placed.a));
    const Vec3 direction = vector(1);
    const Ray ray{i % 2 == 0 ? nudged(target - unit() * direction) : target, direction};
    RayHit hit;
    const ExactResult verdict = cast(ray, own, at, hit);
    const std::optional<Stretch> truth = stretch_in(OwnRay(ray, at), own);
    ASSERT_EQ(verdict.yes(), truth.has_value()) << i;
    if (truth) expect_distance(ray, hit, truth->from);
  }
  EXPECT_GT(turned_, 100);
}

TEST_F(GivenRay, BoxesAreEnteredAndLeftWhereTheirFacesAreGiven) {
  for (int i = 0; i < 3'000; ++i) {
    const Vec3 half = Vec3(2, 2, 2) + vector(1.9);
    const Box own{.center = vector(1), .half_m = half};
    const Pose at = pose();
    // On a face, or at an edge.
    Vec3 local = half.cwiseProduct(vector(1));
    local[i % 3] = unit() < 0 ? -half[i % 3] : half[i % 3];
    if (i % 2 == 0) local[(i + 1) % 3] = half[(i + 1) % 3];
    const Vec3 target = nudged(place(frame_of(at), Vec3(own.center + local)));
    const Vec3 direction = vector(1);
    const Ray ray{i % 4 < 2 ? target : nudged(target - std::abs(unit()) * direction), direction};
    RayHit hit;
    const ExactResult verdict = cast(ray, own, at, hit);
    const std::optional<Stretch> truth = stretch_in(OwnRay(ray, at), own);
    ASSERT_EQ(verdict.yes(), truth.has_value()) << i;
    if (!truth) continue;
    ASSERT_EQ(hit.inside, truth->is_inside) << i;
    expect_distance(ray, hit, truth->from);
    EXPECT_TRUE(std::isfinite(hit.exit_m)) << i;
    EXPECT_GE(hit.exit_m + hit.exit_error_m + 1e-9, hit.distance_m) << i;
  }
  EXPECT_GT(turned_, 100);
}

TEST_F(GivenRay, BallsAreTouchedWhereTheirCentresAreGiven) {
  for (int i = 0; i < 3'000; ++i) {
    const Sphere own{vector(1), 0.5 + std::abs(unit())};
    const Pose at = pose();
    const Sphere placed = place(frame_of(at), own);
    const Vec3 outward = vector(1).normalized();
    const Vec3 touched = nudged(placed.center + placed.radius_m * outward);
    const Vec3 direction = i % 2 == 0 ? Vec3(outward.cross(vector(1))) : vector(1);
    const Ray ray{i % 4 < 2 ? touched : nudged(touched - std::abs(unit()) * direction), direction};
    RayHit hit;
    const ExactResult verdict = cast(ray, own, at, hit);
    ASSERT_EQ(verdict.yes(), meets(OwnRay(ray, at), own)) << i;
  }
  EXPECT_GT(turned_, 100);
}

// The end of a ray is where its length says, which is seldom a double times the direction.
TEST_F(GivenRay, TheEndOfARayCountsToTheLastBit) {
  const Triangle wall{{0, -9, -9}, {0, 9, -9}, {0, 0, 9}};
  const Pose at{.position = {0.1, 0, 0}, .rotation = Quat(1, 0, 0, 0)};
  const Pose beyond{.position = {0.1, 0, 0}, .rotation = Quat(1, 0, 0, 1e-9).normalized()};
  RayHit hit;
  const Ray ray{{-0.2, 0, 0}, {1, 0, 0}, 0.1 + 0.2};  // 0.30000000000000004, beyond the true sum of the two
  EXPECT_TRUE(cast(ray, wall, at, hit).yes());
  EXPECT_TRUE(cast(ray, wall, beyond, hit).yes());
  const Ray shorter{ray.origin, {3, 0, 0}, 0.3};  // 0.299999999999999988898, short of it
  EXPECT_FALSE(cast(shorter, wall, beyond, hit).yes());
}

// Cylinders, cones and ellipsoids: as overlaps_as_given has them, which is decided for a segment as for any other part.
TEST_F(GivenRay, RoundSolidsAgreeWithTheirPointsAsGiven) {
  for (int i = 0; i < 60; ++i) {
    const Pose at = pose();
    const Frame frame = frame_of(at);
    const Cylinder tube{{0, 0, -1}, {0, 0, 1}, 0.5};
    const Vec3 side(0.3, 0.4, 0.7 * unit());  // on the wall, to the last bit but those of 0.3 and 0.4
    const Vec3 start = nudged(place(frame, side));
    const Vec3 inward = frame.rotation * Vec3(-0.3, -0.4, 0.1);
    RayHit hit;
    const ExactResult verdict = cast(Ray{start, inward}, tube, at, hit);
    EXPECT_TRUE(verdict.yes()) << i;
    const Primitive own = tube;
    const GivenPart given{.own = &own, .pose = &at, .frame = &frame};
    const Decision held =
        overlaps_as_given(Primitive(Sphere{start, 0}), Primitive(place(frame, tube)), {GivenPart{}, given});
    EXPECT_EQ(hit.inside, held == Decision::yes) << i;
    EXPECT_NEAR(hit.exit_m, 2 * 0.5 * std::sqrt(0.26) / 0.5, 1e-6) << i;
  }
}

TEST_F(GivenRay, DoubleAloneIsNotTrustedNearTheSurface) {
  const Sphere ball{{0, 0, 0}, 1};
  RayHit hit;
  const auto holds = [&](const Ray& ray, double off_m) {
    hit = {};
    const ExactResult verdict = cast_ray(ray, ball, hit);
    return holds_within(ray, ball, off_m, verdict, hit);
  };
  const double near = 1 - 0x1p-50;  // 8 roundings from the surface, which the check itself may be off by
  EXPECT_FALSE(holds({{0, 0, near}, {1, 0, 0}}, 1e-300));
  EXPECT_FALSE(holds({{-2, 0, near}, {1, 0, 0}}, 1e-300));
  EXPECT_TRUE(holds({{0, 0, 0.999}, {1, 0, 0}}, 1e-12));
  EXPECT_TRUE(holds({{-2, 0, 0.999}, {1, 0, 0}}, 1e-12));
  EXPECT_TRUE(holds({{-2, 0, 1.001}, {1, 0, 0}}, 1e-12));
  EXPECT_FALSE(holds({{-2, 0, 0.999}, {1, 0, 0}, 1.96}, 0.01)) << "it ends too near";
}

}  // namespace
}  // namespace collided::engine::given_ray_test
