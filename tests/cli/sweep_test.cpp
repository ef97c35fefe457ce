#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class SweepVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().sweep = [](const Shape& shape, const SweepQuestion& motion, const AskOptions&) {
      last_shape = shape;
      last_motion = motion;
      return next;
    };
    Hit wall = fake::hit("wall", 0, {0.95, 0, 1});
    wall.time_low = 0.474749;
    wall.time_high = 0.474751;
    wall.normal = {-1, 0, 0};
    next = fake::hit_answer({wall});
  }

  static inline Shape last_shape;
  static inline SweepQuestion last_motion;
  static inline Answer next;
};

TEST_F(SweepVerb, AContactReadsAsASentence) {
  const Ran ran = at_terminal("sweep sphere 0.1 --from 0 0 1 --to 2 0 1");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out, "contact  wall  at t in [0.474749, 0.474751]  point 0.95 0 1  normal -1 0 0\n");
  ASSERT_EQ(last_shape.size(), 1u);
  EXPECT_EQ(std::get<SphereShape>(last_shape[0]).radius_m, 0.1);
  EXPECT_EQ(last_motion.from.position, Vec3(0, 0, 1));
  EXPECT_EQ(last_motion.to.position, Vec3(2, 0, 1));
}

TEST_F(SweepVerb, ARecordHoldsTheBracket) {
  EXPECT_EQ(
      collide("sweep sphere 0.1 --from 0 0 1 --to 2 0 1 --json").out,
      R"({"answer":"contact","object":"wall","time_low":0.474749,"time_high":0.474751,"point":[0.95,0,1],"normal":[-1,0,0]})"
      "\n");
}

TEST_F(SweepVerb, AShapeThatBeginsInASolidIsSaidTo) {
  next.hits[0].inside = true;
  EXPECT_EQ(at_terminal("sweep sphere 0.1 --from 0 0 1 --to 2 0 1").out,
            "contact  wall  at t in [0.474749, 0.474751]  point 0.95 0 1  normal -1 0 0  begins inside\n");
  EXPECT_EQ(collide("sweep sphere 0.1 --from 0 0 1 --to 2 0 1 --fields object,inside").out, "wall\ttrue\n");
}

TEST_F(SweepVerb, ATurnIsToldByItsEnds) {
  collide("sweep box 1 10cm 0.1 --from 0 0 0 --to 0 0 -1 --to-rpy 0 0 90deg");
  EXPECT_EQ(last_motion.from.rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_NEAR(last_motion.to.rotation.angularDistance(Quat::Identity()), M_PI / 2, 1e-15);
  EXPECT_EQ(last_motion.to.position, Vec3(0, 0, -1));
  EXPECT_EQ(std::get<BoxShape>(last_shape[0]).half_m, Vec3(0.5, 0.05, 0.05));
  collide("sweep box 1 10cm 0.1 --from 0 0 0 --to 0 0 1 --rpy 0 0 90deg");
  EXPECT_EQ(last_motion.from.rotation.coeffs(), last_motion.to.rotation.coeffs())
      << "without --to-rpy it does not turn";
}

TEST_F(SweepVerb, ANameThatNoObjectHasIsSaid) {
  next = {};
  fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
    return nlohmann::json{{"objects", nlohmann::json::array()}, {"count", 0}, {"version", 1}}.dump();
  };
  const Ran ran = at_terminal("sweep sphere 0.1 --from 0 0 1 --to 2 0 1 --only nosuch");
  EXPECT_NE(ran.err.find("no object's name matches --only 'nosuch'"), std::string::npos) << ran.err;
}

TEST_F(SweepVerb, FreeAndUndecidedHaveTheirExitCodes) {
  next = {};
  const Ran free = at_terminal("sweep sphere 0.1 --from 0 0 1 --to 2 0 1");
  EXPECT_EQ(free.code, 1);
  EXPECT_EQ(free.out, "free  nothing is met on the way\n");
  next.verdict = Verdict::undecided;
  next.reason = UndecidedReason::numeric;
  EXPECT_EQ(collide("sweep sphere 0.1 --from 0 0 1 --to 2 0 1").code, 3);
}

TEST_F(SweepVerb, WhatIsMissingIsSaid) {
  EXPECT_EQ(collide("sweep sphere 0.1 --from 0 0 1").code, 2);
  EXPECT_EQ(collide("sweep --from 0 0 1 --to 0 0 0").code, 2);
  EXPECT_EQ(collide("sweep sphere --from 0 0 1 --to 0 0 0").code, 2);
}

}  // namespace
}  // namespace collided
