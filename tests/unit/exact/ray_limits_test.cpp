// A19: a ray has an origin, a direction of any length, no negative distances and an end. Spheres on a lattice, directions
// of whole length and whole lengths of rays: starts on the surface and ends on it come by themselves, and whether there is
// a hit is known in whole numbers. That a direction of no length is refused: extreme/service/validation_refusals_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::ray_limits_test {
namespace {

using Whole = std::int64_t;
using WholeVector = std::array<Whole, 3>;

Whole dot(const WholeVector& a, const WholeVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 vec(const WholeVector& v, double scale = 1) {
  return scale * Vec3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
}

struct WholeRay {
  WholeVector origin;  // from the sphere's centre
  WholeVector direction;
  Whole direction_length;
  Whole length;  // negative: endless
};

enum class Meeting { none, at_start, at_end, between, from_inside };

/// Of the numbers: s |d|^2 = -b - sqrt(b^2 - |d|^2 c) for a start outside, and it lies within the length.
Meeting meeting(const WholeRay& ray, Whole radius) {
  const Whole dd = ray.direction_length * ray.direction_length;
  const Whole b = dot(ray.origin, ray.direction);
  const Whole c = dot(ray.origin, ray.origin) - radius * radius;
  if (c < 0) return Meeting::from_inside;
  if (c == 0) return Meeting::at_start;
  const Whole discriminant = b * b - dd * c;
  if (b >= 0 || discriminant < 0) return Meeting::none;
  if (ray.length < 0) return Meeting::between;
  const Whole beyond = -b - ray.length * ray.direction_length;  // of the end, from the middle of the chord
  if (beyond < 0) return Meeting::between;
  if (beyond * beyond > discriminant) return Meeting::none;
  return beyond * beyond == discriminant ? Meeting::at_end : Meeting::between;
}

class Rays {
 public:
  WholeRay operator()() {
    static constexpr std::array<std::array<Whole, 4>, 6> kWholeLengths{
        {{1, 0, 0, 1}, {1, 2, 2, 3}, {2, 3, 6, 7}, {1, 4, 8, 9}, {4, 4, 7, 9}, {3, 4, 0, 5}}};
    const auto& shape = kWholeLengths[random_() % kWholeLengths.size()];
    const auto first = static_cast<std::size_t>(random_() % 3);
    WholeRay ray;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.direction[axis] = random_() % 2 == 0 ? shape[(axis + first) % 3] : -shape[(axis + first) % 3];
      ray.origin[axis] = static_cast<Whole>(random_() % 25) - 12;
    }
    ray.direction_length = shape[3];
    ray.length = random_() % 4 == 0 ? -1 : static_cast<Whole>(random_() % 20);
    return ray;
  }
  Whole number(Whole most) { return static_cast<Whole>(random_() % static_cast<std::uint64_t>(most)); }

 private:
  std::mt19937_64 random_ = oracle::seeded(19);
};

TEST(ExactRayLimits, AHitLiesBetweenTheStartAndTheEndBothIncluded) {
  Rays rays;
  std::array<int, 5> seen{};
  for (int i = 0; i < 1'000'000; ++i) {
    const WholeRay whole = rays();
    const Whole radius = rays.number(8);
    const Meeting truth = meeting(whole, radius);
    ++seen[static_cast<std::size_t>(truth)];
    // A length is metres whatever the direction's: the stretch does not show.
    const double stretch = std::ldexp(1.0, static_cast<int>(rays.number(80)) - 40);
    const Ray ray{vec(whole.origin), vec(whole.direction, stretch),
                  whole.length < 0 ? std::numeric_limits<double>::infinity() : static_cast<double>(whole.length)};
    RayHit hit;
    const ExactResult found = cast_ray(ray, Sphere{Vec3::Zero(), static_cast<double>(radius)}, hit);
    ASSERT_EQ(found.decision, truth == Meeting::none ? Decision::no : Decision::yes) << i;
    if (!found.yes()) continue;
    ASSERT_GE(hit.distance_m, 0) << i;
    ASSERT_LE(hit.distance_m, ray.length_m) << i;
    if (truth == Meeting::at_start || truth == Meeting::from_inside) {
      ASSERT_EQ(hit.distance_m, 0) << i;
    } else if (truth == Meeting::at_end) {
      ASSERT_LE(std::abs(hit.distance_m - ray.length_m), hit.distance_error_m) << i;
    }
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace collided::engine::ray_limits_test
