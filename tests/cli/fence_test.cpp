#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class FenceVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
};

TEST_F(FenceVerb, RegionsAreReadAsTheHelpSays) {
  EXPECT_EQ(collide("fence add dock box 5 5 3 0 -1 0 --only 'fork*' --detect enter,exit --keep").code, 0);
  ASSERT_EQ(fake::server().fences.size(), 1u);
  const Fence dock = fake::server().fences[0];
  EXPECT_EQ(dock.name, "dock");
  EXPECT_EQ(dock.only, "fork*");
  EXPECT_TRUE(dock.keep && dock.enter && dock.exit && !dock.cross);
  const BoxShape& box = std::get<BoxShape>(dock.shape.at(0));
  EXPECT_EQ(box.center, Vec3(2.5, 2, 1.5));
  EXPECT_EQ(box.half_m, Vec3(2.5, 3, 1.5));
  EXPECT_EQ(collide("fence add yard prism 0 4  0 0  9 0  9 6 --to cart --keep").code, 0);
  const Fence yard = fake::server().fences[1];
  EXPECT_EQ(yard.to, "cart");
  ASSERT_TRUE(yard.prism);
  EXPECT_EQ(yard.prism->high_m, 4);
  EXPECT_EQ(yard.prism->corners.size(), 3u);
  EXPECT_EQ(collide("fence add ball sphere 1 2 3").code, 2) << "a sphere takes four numbers";
  EXPECT_EQ(collide("fence add ball cube 1 2 3").code, 2);
  EXPECT_EQ(collide("fence add ball sphere 1 2 3 4 --detect leave").code, 2);
  EXPECT_EQ(fake::server().fences.size(), 2u);
}

TEST_F(FenceVerb, WatchSaysWhatHappened) {
  using namespace std::chrono_literals;
  fake::server().fence_events = {{.kind = FenceEventKind::enter, .object = "cart", .fence = "dock", .world_time = 10s},
                                 {.kind = FenceEventKind::exit,
                                  .reason = EndReason::removed,
                                  .object = "cart",
                                  .fence = "dock",
                                  .world_time = 12s,
                                  .entered = 10s}};
  EXPECT_EQ(collide("fence watch dock -q -n 2 --fields what,object,fence,after,why").out,
            "enter\tcart\tdock\t\t\nexit\tcart\tdock\t2\tremoved\n");
  EXPECT_EQ(fake::server().fences_watched_with.only, "dock");
}

}  // namespace
}  // namespace collided
