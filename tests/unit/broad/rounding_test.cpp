#include <gtest/gtest.h>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"

namespace collided::engine {
namespace {

[[gnu::noinline]] void through_float(double* values) {
  for (int i = 0; i < 3; ++i) values[i] = static_cast<double>(static_cast<float>(values[i]));
}

// g++ 12.2 at -O2 and -O3 returns the first two values unrounded unless its SLP pass is off: it folds the two vector
// conversions away. What then passes for a float is not one.
TEST(BroadRounding, TheCompilerKeepsRoundingsToFloat) {
  double values[3] = {0.1, 0.2, 0.3};
  through_float(values);
  EXPECT_EQ(values[0], static_cast<double>(0.1f));
  EXPECT_EQ(values[1], static_cast<double>(0.2f));
  EXPECT_EQ(values[2], static_cast<double>(0.3f));
}

TEST(BroadRounding, DirectedRoundingsEncloseAndAreTight) {
  for (const double value : {0.1, -0.1, 1.0, 0.0, 1e-50, -1e-50, 1e-45, 16777217.0, -16777217.0, 3e38}) {
    const float low = bvh::round_down(value);
    const float high = bvh::round_up(value);
    EXPECT_LE(static_cast<double>(low), value);
    EXPECT_GE(static_cast<double>(high), value);
    EXPECT_GE(std::nextafter(low, high), high);
  }
}

TEST(BroadRounding, LocalFramesAreExactForTheirScene) {
  for (const double offset : {0.0, 3.0, 1e3, -1e6, 1e9, 1e15}) {
    Aabb bounds;
    bounds.extend(Vec3(offset, -offset, 2 * offset));
    bounds.extend(Vec3(offset + 10, -offset + 1.25, 2 * offset + 5));
    const bvh::LocalFrame frame = bvh::local_frame(bounds);
    for (const Vec3& corner : {bounds.low, bounds.high}) {
      const Vec3 local = frame.to_local(corner);
      EXPECT_LE(local.cwiseAbs().maxCoeff(), 1);
      EXPECT_EQ(Vec3(local * frame.inverse_scale + frame.origin), corner);
    }
    EXPECT_TRUE(frame.is_float(bounds.low));
    EXPECT_FALSE(frame.is_float(bounds.low + Vec3(0, 0, 0.1)) && offset < 1e9);
  }
}

}  // namespace
}  // namespace collided::engine
