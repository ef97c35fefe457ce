// From a bacterium's parts (1e-12 m) to the orbit of Saturn (1e12 m): a tolerance in metres is wrong at one end or both.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::decades_test {
namespace {

/// 10^-12 .. 10^12, each rounded to a double.
template <class Check>
void at_every_decade(const Check& check) {
  for (int decade = -12; decade <= 12; ++decade) {
    SCOPED_TRACE(decade);
    check(std::strtod(("1e" + std::to_string(decade)).c_str(), nullptr));
  }
}

TEST(ExtremeDecades, RaysKeepSixteenDigits) {
  at_every_decade([](double m) {
    RayHit hit;
    ASSERT_TRUE(cast_ray({{-3 * m, 0, 0}, {m, 0, 0}}, Sphere{{0, 0, 0}, m}, hit).yes());
    EXPECT_NEAR(hit.distance_m / m, 2, 1e-15);
    ASSERT_TRUE(cast_ray({{0, -3 * m, 0}, {0, m, 0}}, Box{.center = {0, 0, 0}, .half_m = {m, m, m}}, hit).yes());
    EXPECT_NEAR(hit.distance_m / m, 2, 1e-15);
    ASSERT_TRUE(cast_ray({{0, 0, 3 * m}, {0, 0, -m}}, Triangle{{-m, -m, m}, {m, -m, m}, {0, m, m}}, hit).yes());
    EXPECT_NEAR(hit.distance_m / m, 2, 1e-15);
    ASSERT_TRUE(cast_ray({{3 * m, 0, 0}, {-m, 0, 0}}, Capsule{{0, -m, 0}, {0, m, 0}, m}, hit).yes());
    EXPECT_NEAR(hit.distance_m / m, 2, 1e-15);
    EXPECT_FALSE(cast_ray({{-3 * m, 1.001 * m, 0}, {m, 0, 0}}, Sphere{{0, 0, 0}, m}, hit).yes());
  });
}

TEST(ExtremeDecades, DepthsKeepFifteenDigits) {
  at_every_decade([](double m) {
    const Sphere ball{{1.5 * m, 0, 0}, m};
    const Box box{.center = {0, 0, 0}, .half_m = {m, 2 * m, 3 * m}};
    EXPECT_NEAR(contact(Sphere{{0, 0, 0}, m}, ball).depth_m / m, 0.5, 1e-15);
    EXPECT_NEAR(contact(ball, box).depth_m / m, 0.5, 1e-15);
    EXPECT_NEAR(contact(box, Box{.center = {0, 2.5 * m, 0}, .half_m = {m, m, m}}).depth_m / m, 0.5, 1e-15);
    EXPECT_NEAR(contact(ball, Capsule{{0, 0, -m}, {0, 0, m}, m}).depth_m / m, 0.5, 1e-15);
    const Triangle wall{{m, -9 * m, -9 * m}, {m, 9 * m, -9 * m}, {m, 0, 9 * m}};
    EXPECT_NEAR(contact(ball, wall).depth_m / m, 0.5, 1e-15);
  });
}

TEST(ExtremeDecades, AThousandthApartIsApart) {
  at_every_decade([](double m) {
    EXPECT_FALSE(overlaps(Sphere{{0, 0, 0}, m}, Sphere{{2.001 * m, 0, 0}, m}).yes());
    EXPECT_FALSE(
        overlaps(Box{.center = {0, 0, 0}, .half_m = {m, m, m}}, Box{.center = {2.001 * m, 0, 0}, .half_m = {m, m, m}})
            .yes());
    EXPECT_TRUE(
        overlaps(Box{.center = {0, 0, 0}, .half_m = {m, m, m}}, Box{.center = {1.999 * m, 0, 0}, .half_m = {m, m, m}})
            .yes());
    EXPECT_NEAR(closest({3 * m, 0, 0}, Box{.center = {0, 0, 0}, .half_m = {m, m, m}}).distance_m / m, 2, 1e-15);
  });
}

}  // namespace
}  // namespace collided::engine::decades_test
