// The judge of certificates believes what is proved and nothing else.  // A25
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "collided/certificate.hpp"

namespace collided {
namespace {

using Summand = CertifiedPart::Summand;
using Kind = Certificate::Step::Kind;
using Numbers = CertifiedPart::Numbers;

constexpr std::array<Numbers, 3> kAxes{Numbers{1, 0, 0}, Numbers{0, 1, 0}, Numbers{0, 0, 1}};

CertifiedPart ball(const Numbers& center, double radius_m) {
  return {.summand = Summand::ball, .points = {center}, .radius_m = radius_m};
}
CertifiedPart box(const Numbers& center, const Numbers& half_m) {
  return {.summand = Summand::box, .points = {center}, .axes = kAxes, .half_m = half_m};
}
CertifiedPart egg(const Numbers& center, const Numbers& half_m) {
  return {.summand = Summand::ellipsoid, .points = {center}, .axes = kAxes, .half_m = half_m};
}
CertifiedPart triangle(const Numbers& a, const Numbers& b, const Numbers& c) { return {.points = {a, b, c}}; }
CertifiedPart disc(const Numbers& a, const Numbers& b, double radius_m, bool tapers) {
  return {.summand = Summand::disc, .points = {a, b}, .radius_m = radius_m, .tapers = tapers};
}
CertifiedPart ground(const Numbers& point, const Numbers& normal) {
  return {.summand = Summand::half_space, .points = {point}, .axes = {normal}};
}

Certificate apart(const CertifiedPart& a, const CertifiedPart& b, const Numbers& normal, const Numbers& point) {
  return {.touches = false, .a = {a}, .b = {b}, .steps = {{.kind = Kind::plane, .normal = normal, .point = point}}};
}

Certificate touching(const CertifiedPart& a, const CertifiedPart& b, const Numbers& point,
                     const Certificate::Mix& mix_a = {{0, {1}}}, const Certificate::Mix& mix_b = {{0, {1}}}) {
  return {.touches = true,
          .a = {a},
          .b = {b},
          .point = {Certificate::Sum{point[0]}, {point[1]}, {point[2]}},
          .divisor = {1},
          .mix_a = mix_a,
          .mix_b = mix_b};
}

constexpr double kUlp = 0x1p-52;

// Every kind, a double before and behind the plane through its farthest point at x = 1.
TEST(Certificate, APlaneIsBelievedToTheLastBit) {
  const CertifiedPart kinds[] = {ball({0, 0, 0}, 1),
                                 {.summand = Summand::ball, .points = {{-3, 0, 0}, {0, 2, 0}}, .radius_m = 1},
                                 box({0, 5, 0}, {1, 2, 3}),
                                 egg({0, 5, 0}, {1, 2, 3}),
                                 triangle({1, 0, 0}, {-1, 4, 0}, {0, 0, 4}),
                                 disc({1, 0, 0}, {-1, 0, 0}, 3, false),
                                 disc({0, -2, 0}, {0, 2, 0}, 1, false),
                                 disc({1, 0, 0}, {-1, 0, 0}, 3, true),
                                 disc({0, -2, 0}, {0, 2, 0}, 1, true),
                                 ground({1, 7, 7}, {4, 0, 0})};
  for (const CertifiedPart& part : kinds) {
    const CertifiedPart beyond = ball({3, 0, 0}, 1);
    EXPECT_TRUE(proves(apart(part, beyond, {1, 0, 0}, {1, 0, 0}))) << static_cast<int>(part.summand);
    EXPECT_FALSE(proves(apart(part, beyond, {1, 0, 0}, {1 - kUlp, 0, 0}))) << static_cast<int>(part.summand);
    EXPECT_FALSE(proves(apart(beyond, part, {-1, 0, 0}, {1, 0, 0}))) << "b must be strictly ahead";
    EXPECT_TRUE(proves(apart(beyond, part, {-1, 0, 0}, {1 + kUlp, 0, 0}))) << static_cast<int>(part.summand);
    EXPECT_FALSE(proves(apart(part, beyond, {0, 0, 0}, {1, 0, 0}))) << "no normal, no plane";
    EXPECT_FALSE(proves(apart(part, beyond, {-1, 0, 0}, {1, 0, 0})));
    EXPECT_FALSE(proves(apart(part, ball({3, 0, 0}, 2), {1, 0, 0}, {1, 0, 0}))) << "touching";
  }
  EXPECT_FALSE(proves(apart(ground({1, 7, 7}, {4, 0, 0}), ball({3, 0, 0}, 1), {1, 1e-300, 0}, {1, 0, 0})))
      << "no end that way";
}

TEST(Certificate, ACommonPointIsBelievedToTheLastBit) {
  const CertifiedPart at_one = ball({2, 0, 0}, 1);
  EXPECT_TRUE(proves(touching(ball({0, 0, 0}, 1), at_one, {1, 0, 0})));
  EXPECT_FALSE(proves(touching(ball({0, 0, 0}, 1), at_one, {1 + kUlp, 0, 0})));
  EXPECT_FALSE(proves(touching(ball({0, 0, 0}, 1 - kUlp), at_one, {1, 0, 0})));
  EXPECT_TRUE(proves(touching(box({0, 0, 0}, {1, 1, 1}), at_one, {1, 0, 0})));
  EXPECT_FALSE(proves(touching(box({0, 0, 0}, {1 - kUlp, 1, 1}), at_one, {1, 0, 0})));
  EXPECT_TRUE(proves(touching(egg({0, 0, 0}, {1, 2, 3}), at_one, {1, 0, 0})));
  EXPECT_FALSE(proves(touching(egg({0, 0, 0}, {1 - kUlp, 2, 3}), at_one, {1, 0, 0})));
  EXPECT_TRUE(proves(touching(ground({1, 5, 5}, {1, 0, 0}), at_one, {1, 0, 0})));
  EXPECT_FALSE(proves(touching(ground({1 - kUlp, 5, 5}, {1, 0, 0}), at_one, {1, 0, 0})));
  // Beside the middle of a cylinder's axis; half way down a cone half its radius is left.
  const Certificate::Mix middle{{0, {0.5}}, {1, {0.5}}};
  EXPECT_TRUE(proves(touching(disc({0, -1, 0}, {0, 1, 0}, 1, false), at_one, {1, 0, 0}, middle)));
  EXPECT_FALSE(proves(touching(disc({0, -1, 0}, {0, 1, 0}, 1, true), at_one, {1, 0, 0}, middle)));
  EXPECT_TRUE(proves(touching(disc({0, -1, 0}, {0, 1, 0}, 2, true), at_one, {1, 0, 0}, middle)));
  EXPECT_FALSE(proves(touching(disc({0, -1, 0}, {0, 1, 0}, 2 - 2 * kUlp, true), at_one, {1, 0, 0}, middle)));
  // A point of a triangle's inside, as thirds of its corners: 3 is the divisor.
  Certificate thirds =
      touching(triangle({1, 0, 0}, {1, 1, 0}, {1, -1, 3}), at_one, {3, 0, 3}, {{0, {1}}, {1, {1}}, {2, {1}}});
  thirds.divisor = {3};
  EXPECT_FALSE(proves(thirds)) << "outside the ball";
  thirds.b = {ball({2, 0, 1}, 1)};
  EXPECT_TRUE(proves(thirds));
}

/// Certificates that hold, and every way of spoiling them.
TEST(Certificate, PlantedWrongOnesAreRefused) {
  const Certificate::Mix thirds{{0, {1}}, {1, {1}}, {2, {1}}};
  Certificate good = touching(triangle({0, 0, 0}, {3, 0, 0}, {0, 3, 0}), box({1, 1, 1}, {1, 1, 1}), {1, 1, 0}, thirds);
  good.point = {Certificate::Sum{1}, {1}, {0}};
  ASSERT_TRUE(proves(good));
  const std::vector<std::pair<const char*, std::function<void(Certificate&)>>> spoilers{
      {"another point",
       [](Certificate& c) {
         c.point[0] = {1, 0x1p-60};
       }},
      {"a point off the plane", [](Certificate& c) { c.point[2] = {0x1p-70}; }},
      {"other weights",
       [](Certificate& c) {
         c.mix_a[1].second = {1, 0x1p-60};
       }},
      {"a weight below 0", [](Certificate& c) { c.mix_a[0].second = {-1}; }},
      {"weights that are nothing", [](Certificate& c) { c.mix_a = {}; }},
      {"a corner that is not there", [](Certificate& c) { c.mix_a[0].first = 3; }},
      {"a divisor of 0", [](Certificate& c) { c.divisor = {0}; }},
      {"a divisor below 0", [](Certificate& c) { c.divisor = {-1}; }},
      {"no divisor", [](Certificate& c) { c.divisor = {}; }},
      {"not a number", [](Certificate& c) { c.point[0] = {std::nan("")}; }},
      {"out of range", [](Certificate& c) { c.a[0].points[0][0] = 1e300; }},
      {"a box that is not there", [](Certificate& c) { c.b[0].points[0][2] = 1 + kUlp; }},
      {"a box without axes", [](Certificate& c) { c.b[0].axes = {}; }},
      {"no part", [](Certificate& c) { c.a.clear(); }},
      {"a part without points", [](Certificate& c) { c.b[0].points.clear(); }},
      {"the other answer", [](Certificate& c) { c.touches = false; }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Certificate bad = good;
    spoil(bad);
    EXPECT_FALSE(proves(bad)) << what;
  }
}

// Two triangles on either side of a third that no one plane parts from both.
TEST(Certificate, ASplitProvesEachHalf) {
  Certificate good{.touches = false,
                   .a = {triangle({-1, 0, 0}, {-1, 1, 0}, {-1, 0, 1}), triangle({1, 0, 0}, {1, 1, 0}, {1, 0, 1})},
                   .b = {triangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1})},
                   .steps = {{.kind = Kind::split_a, .at = 1},
                             {.kind = Kind::plane, .normal = {1, 0, 0}, .point = {-1, 0, 0}},
                             {.kind = Kind::plane, .normal = {-1, 0, 0}, .point = {1, 0, 0}}}};
  ASSERT_TRUE(proves(good));
  const std::vector<std::pair<const char*, std::function<void(Certificate&)>>> spoilers{
      {"half of the proof", [](Certificate& c) { c.steps.pop_back(); }},
      {"no proof", [](Certificate& c) { c.steps.clear(); }},
      {"halves turned round", [](Certificate& c) { std::swap(c.steps[1], c.steps[2]); }},
      {"one plane for both", [](Certificate& c) { c.steps.erase(c.steps.begin()); }},
      {"a half of nothing", [](Certificate& c) { c.steps[0].at = 0; }},
      {"a half of all", [](Certificate& c) { c.steps[0].at = 2; }},
      {"a split of the single one", [](Certificate& c) { c.steps[0].kind = Kind::split_b; }},
      {"a split without end", [](Certificate& c) { c.steps.assign(3, {.kind = Kind::split_a, .at = 1}); }},
      {"parts that touch", [](Certificate& c) { c.a[1].points[0][0] = 0; }},
      {"no part", [](Certificate& c) { c.b.clear(); }},
      {"not a number", [](Certificate& c) { c.steps[1].normal[1] = std::nan(""); }},
      {"an endless number", [](Certificate& c) { c.steps[1].point[1] = std::numeric_limits<double>::infinity(); }},
  };
  for (const auto& [what, spoil] : spoilers) {
    Certificate bad = good;
    spoil(bad);
    EXPECT_FALSE(proves(bad)) << what;
  }
}

}  // namespace
}  // namespace collided
