#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::speed_test {
namespace {

/// Best of a few passes, printed for the record; what is asserted is that the first rung decided, since that is what
/// the time stands on.
template <class Ask>
void time_asks(const char* name, int count, const Ask& ask) {
  double best_ns = 1e300;
  int above_filter = 0;
  for (int pass = 0; pass < 5; ++pass) {
    above_filter = 0;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) above_filter += ask(i).level != Level::filter;
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
    best_ns = std::min(best_ns, spent.count() / count);
  }
  std::printf("%s: %.1f ns, %d of %d above the filter\n", name, best_ns, above_filter, count);
  EXPECT_LE(above_filter, count / 1000) << name;
}

TEST(ExactSpeed, GenericQuestionsStayOnTheFirstRung) {
  std::mt19937_64 generator = oracle::seeded(91);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  constexpr int kCount = 4096;
  std::vector<Triangle> triangles;
  std::vector<Ray> hitting, missing;
  std::vector<Box> boxes;
  std::vector<Sphere> spheres;
  for (int i = 0; i < kCount; ++i) {
    const Triangle t = shapes.triangle();
    const Vec3 origin = shapes.point();
    hitting.push_back({origin, (t.a + t.b + t.c) / 3 - origin});
    missing.push_back({origin, 2 * t.b - t.a - origin});
    triangles.push_back(t);
    boxes.push_back(shapes.box());
    spheres.push_back(shapes.sphere());
  }
  RayHit hit;
  time_asks("ray/triangle, hit", kCount, [&](int i) { return cast_ray(hitting[i], triangles[i], hit); });
  time_asks("ray/triangle, miss", kCount, [&](int i) { return cast_ray(missing[i], triangles[i], hit); });
  time_asks("triangle/triangle", kCount - 1, [&](int i) { return overlaps(triangles[i], triangles[i + 1]); });
  time_asks("box/box", kCount - 1, [&](int i) { return overlaps(boxes[i], boxes[i + 1]); });
  time_asks("box/triangle", kCount, [&](int i) { return overlaps(boxes[i], triangles[i]); });
  time_asks("sphere/triangle", kCount, [&](int i) { return overlaps(spheres[i], triangles[i]); });
}

}  // namespace
}  // namespace collided::engine::speed_test
