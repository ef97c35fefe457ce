#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::ray_oracle_test {
namespace {

using oracle::Family;
using oracle::figure;
using oracle::RandomShapes;
using oracle::Wide;

/// |reported - true| <= bound, in 100 digits; 1e-90 is for the oracle's own last digits.
void expect_honest(const RayHit& hit, const Wide& truth, const char* family, int i) {
  const Wide error = abs(Wide(hit.distance_m) - truth);
  EXPECT_LE(error, Wide(hit.distance_error_m) + truth * Wide(1e-90)) << family << " " << i << " truth " << truth;
  EXPECT_LE(hit.distance_error_m, 2e-9 * hit.distance_m) << family << " " << i;
}

template <class MakeShape, class Twin>
void compare(int count, std::uint64_t seed, MakeShape make, Twin twin) {
  std::mt19937_64 generator = oracle::seeded(seed);
  int yes = 0;
  int no = 0;
  for (const Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < count; ++i) {
      const auto shape = make(shapes);
      const Ray ray = shapes.ray(i % 3 == 0);
      RayHit hit;
      const ExactResult verdict = cast_ray(ray, shape, hit);
      const std::optional<Wide> truth = twin(ray, shape);
      ASSERT_EQ(verdict.decision, truth ? Decision::yes : Decision::no) << name(family) << " " << i;
      ++(truth ? yes : no);
      if (truth) expect_honest(hit, *truth, name(family), i);
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(yes, count / 10);
  EXPECT_GT(no, count / 10);
}

const auto kByParameter = [](const Ray& ray, const auto& shape) -> std::optional<Wide> {
  const auto parameter = oracle::first_parameter(ray, shape);
  if (!parameter) return std::nullopt;
  return Wide(*parameter) * oracle::length(ray.direction);
};
const auto kByDistance = [](const Ray& ray, const auto& shape) -> std::optional<Wide> {
  if (!oracle::ray_meets(ray, figure(shape))) return std::nullopt;
  return oracle::first_distance(ray, figure(shape));
};

TEST(ExactRayOracle, Triangle) {
  compare(
      400, 21, [](RandomShapes& s) { return s.triangle(); }, kByParameter);
}
TEST(ExactRayOracle, Box) {
  compare(
      300, 22, [](RandomShapes& s) { return s.box(); }, kByParameter);
}
TEST(ExactRayOracle, Sphere) {
  compare(
      40, 23, [](RandomShapes& s) { return s.sphere(); }, kByDistance);
}
TEST(ExactRayOracle, Capsule) {
  compare(
      40, 24, [](RandomShapes& s) { return s.capsule(); }, kByDistance);
}

}  // namespace
}  // namespace collided::engine::ray_oracle_test
