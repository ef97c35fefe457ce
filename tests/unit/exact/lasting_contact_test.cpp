// What is proved to touch throughout a span touches at each of its times, and spans become provable as they get short.
#include "server/exact_phase/motion/lasting_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

class RandomPairs {
 public:
  explicit RandomPairs(std::mt19937_64& random) : random_(random), shapes_(random, oracle::Family::random) {}

  /// kind  of oracle::RandomShapes, or a triangle for -1
  ConvexPart part(int kind) {
    if (kind >= 0) return shapes_.solid(kind);
    return shapes_.triangle();
  }
  BodyMotion motion(double size_m, double turn_rad) {
    const Quat from = rotation();
    const Vec3 axis = shapes_.point().normalized();
    const Quat turned = Quat(Eigen::AngleAxisd(turn_rad, axis)) * from;
    return {frame_of({size_m * shapes_.point(), from}), frame_of({size_m * shapes_.point(), turned})};
  }
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int kind() { return std::uniform_int_distribution<int>(-1, 6)(random_); }

 private:
  Quat rotation() { return Quat(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized(); }

  std::mt19937_64& random_;
  oracle::RandomShapes shapes_;
};

bool are_both(const ConvexPart& a, const ConvexPart& b) {
  return std::holds_alternative<Triangle>(a) && std::holds_alternative<Triangle>(b);
}

TEST(LastingContact, WhatIsProvedToLastTouchesAtEachTime) {
  std::mt19937_64 random = oracle::seeded(5021);
  RandomPairs pairs(random);
  int proved = 0;
  int proved_triangles = 0;
  for (int i = 0; i < 6'000; ++i) {
    const bool are_triangles = i % 4 == 0;
    const ConvexPart own_a = pairs.part(are_triangles ? -1 : pairs.kind());
    const ConvexPart own_b = pairs.part(are_triangles ? -1 : pairs.kind());
    const double turn_rad = std::exp2(pairs.in(-8, 1));
    const BodyMotion on_a = pairs.motion(0.3, turn_rad);
    const BodyMotion on_b = pairs.motion(0.3, pairs.in(0, 1) < 0.5 ? turn_rad : 0);
    const PartOnMotion a{own_a, on_a};
    const PartOnMotion b{own_b, on_b};
    const double low = pairs.in(0, 0.5);
    const TimeSpan span{low, low + std::exp2(pairs.in(-8, -1))};
    if (shortfall_between(a, b, span, 0) != 0) continue;
    ++proved;
    if (are_both(own_a, own_b)) ++proved_triangles;
    constexpr int kSamples = 16;
    for (int k = 0; k <= kSamples; ++k) {
      const double t = span.low + (span.high - span.low) * k / kSamples;
      ASSERT_TRUE(overlaps(a.at(t), b.at(t)).yes()) << "pair " << i << ", kinds " << own_a.index() << " and "
                                                    << own_b.index() << ", sample " << k << " of " << kSamples;
    }
  }
  std::printf("proved=%d of_triangles=%d\n", proved, proved_triangles);
  EXPECT_GT(proved, 1'000);
  EXPECT_GT(proved_triangles, 100);
}

// Halving the span around a time of contact ends with a proof, wherever the contact's point lies beside what they share.
TEST(LastingContact, AShortSpanInAContactIsProved) {
  std::mt19937_64 random = oracle::seeded(5022);
  RandomPairs pairs(random);
  int touching = 0;
  int open = 0;
  for (int i = 0; i < 4'000; ++i) {
    const ConvexPart own_a = pairs.part(pairs.kind());
    const ConvexPart own_b = pairs.part(pairs.kind());
    const BodyMotion on_a = pairs.motion(0.3, pairs.in(0.1, 1));
    const BodyMotion on_b = pairs.motion(0.3, pairs.in(0.1, 1));
    const PartOnMotion a{own_a, on_a};
    const PartOnMotion b{own_b, on_b};
    const ConvexPart at_a = a.at(0.5);
    const ConvexPart at_b = b.at(0.5);
    if (!overlaps(at_a, at_b).yes() || contact(at_a, at_b).depth_m < 0x1p-6) continue;
    ++touching;
    double half = 0.5;
    while (half > 0x1p-30 && shortfall_between(a, b, {0.5 - half, 0.5 + half}, 0) != 0) half /= 2;
    if (half <= 0x1p-12) ++open;
  }
  std::printf("touching=%d open=%d\n", touching, open);
  EXPECT_GT(touching, 1'000);
  EXPECT_LT(open, touching / 100);
}

// An object that turns on the one it stands on touches it by no more than rounding: nothing proves it, and that shows.
TEST(LastingContact, WhatTouchesByARoundingAloneIsHopeless) {
  const ConvexPart floor = Primitive(Box{Vec3(0, 0, -0.5), Mat3::Identity(), Vec3(4, 4, 0.5)});
  const ConvexPart crate = Primitive(Box{Vec3(0, 0, 0.25), Mat3::Identity(), Vec3(0.25, 0.25, 0.25)});
  const BodyMotion rest = BodyMotion::resting({});
  const BodyMotion turns(frame_of({}), frame_of({Vec3::Zero(), Quat(std::cos(0.5), 0, 0, std::sin(0.5))}));
  const double missing = shortfall_between({crate, turns}, {floor, rest}, {0, 1}, 0);
  EXPECT_GT(missing, 0x1p14);
  EXPECT_LT(missing, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace collided::engine
