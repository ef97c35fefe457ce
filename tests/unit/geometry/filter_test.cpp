#include <gtest/gtest.h>

#include "server/geometry/shape.hpp"

namespace collided::engine {
namespace {

TEST(Filter, MembersOfOneGroupNeverMeet) {
  const Filter bone{.group = 7};
  EXPECT_FALSE(may_meet(bone, bone));
  EXPECT_TRUE(may_meet(bone, Filter{}));
}

TEST(Filter, BothSidesMustAgree) {
  const Filter cargo{.layers = 2, .mask = 1};
  EXPECT_TRUE(may_meet(cargo, Filter{.layers = 1}));
  EXPECT_FALSE(may_meet(cargo, Filter{.layers = 1, .mask = 1}));
}

}  // namespace
}  // namespace collided::engine
