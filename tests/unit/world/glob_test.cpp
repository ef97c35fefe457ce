#include <gtest/gtest.h>

#include "server/world/query/query.hpp"

namespace collided::engine {
namespace {

TEST(Glob, StarTakesAnyRunIncludingNone) {
  EXPECT_TRUE(glob_matches("pallet_*", "pallet_07"));
  EXPECT_TRUE(glob_matches("pallet_*", "pallet_"));
  EXPECT_FALSE(glob_matches("pallet_*", "pallet"));
  EXPECT_TRUE(glob_matches("*shelf*top", "warehouse/shelf_3/top"));
}

TEST(Glob, SetsAndSingleCharacters) {
  EXPECT_TRUE(glob_matches("link_[0-4]", "link_3"));
  EXPECT_FALSE(glob_matches("link_[!0-4]", "link_3"));
  EXPECT_TRUE(glob_matches("link_?", "link_9"));
  EXPECT_TRUE(glob_matches("a[b", "a[b")) << "a set without an end is plain text";
}

// Backtracking over many stars must not explode: one remembered star is enough.
TEST(Glob, ManyStarsTakeLittleTime) {
  EXPECT_FALSE(glob_matches("*a*a*a*a*a*a*a*a*a*a*b", std::string(5'000, 'a')));
}

}  // namespace
}  // namespace collided::engine
