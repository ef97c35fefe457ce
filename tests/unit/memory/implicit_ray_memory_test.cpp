#include <gtest/gtest.h>

#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/intake/readers/polynomial_text.hpp"
#include "tests/unit/memory/counting.hpp"

namespace collided::engine {
namespace {

// A ray that double decides takes no memory; one that touches, which rationals decide, does, so that the count is one.
TEST(ImplicitRayMemory, RaysThatDoubleDecidesAllocateNothing) {
  const ImplicitSurface torus = read_implicit_surface("(x^2+y^2+z^2+3)^2 - 16*(x^2+y^2)");
  const auto grown_by = [&](const Ray& ray, Level level, bool met) {
    ImplicitHit hit;
    const std::size_t before = test::held_bytes();
    test::most_held_from_now();
    const ExactResult verdict = cast_ray(ray, torus, hit, 0x1p-40);
    EXPECT_EQ(verdict.level, level);
    EXPECT_EQ(verdict.yes(), met);
    return test::most_held_bytes() - before;
  };
  EXPECT_EQ(grown_by({{0.1, 2.2, 5}, {0, 0.1, -1}}, Level::filter, true), 0u);
  EXPECT_EQ(grown_by({{0.1, 5.2, 5}, {0, 0.1, -1}}, Level::filter, false), 0u);
  EXPECT_GT(grown_by({{-5, 3, 0}, {1, 0, 0}}, Level::rational, true), 0u);
}

}  // namespace
}  // namespace collided::engine
