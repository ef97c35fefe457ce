#include <gtest/gtest.h>

#include <fnmatch.h>

#include <random>

#include "idl/glob.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::wire_contract {
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

// The system's own matcher, in the locale of every program that sets none; it has classes such as [:alpha:] besides.
TEST(Glob, AgreesWithTheSystemsMatcher) {
  std::mt19937_64 random = oracle::seeded(20261123);
  const std::string letters = "ab/_*?[]-!";
  const auto word = [&](const std::string& of, std::size_t most) {
    std::string text(random() % (most + 1), ' ');
    for (char& c : text) c = of[random() % of.size()];
    return text;
  };
  int matched = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::string pattern = word(letters, 7);
    const std::string text = word("ab/_-", 6);
    const bool theirs = ::fnmatch(pattern.c_str(), text.c_str(), FNM_NOESCAPE) == 0;
    ASSERT_EQ(glob_matches(pattern, text), theirs) << "'" << pattern << "' '" << text << "'";
    matched += theirs ? 1 : 0;
  }
  EXPECT_GT(matched, 1'000);
}

TEST(Glob, OfATextMatchesThatTextAlone) {
  std::mt19937_64 random = oracle::seeded(20261127);
  const std::string letters = "ab*?[]-!^";
  const auto word = [&] {
    std::string text(random() % 6, ' ');
    for (char& c : text) c = letters[random() % letters.size()];
    return text;
  };
  int same = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::string a = word(), b = word();
    ASSERT_TRUE(glob_matches(glob_of(a), a)) << "'" << a << "'";
    ASSERT_EQ(glob_matches(glob_of(a), b), a == b) << "'" << a << "' '" << b << "'";
    same += a == b ? 1 : 0;
  }
  EXPECT_GT(same, 100);
}

// Backtracking over many stars must not explode: one remembered star is enough.
TEST(Glob, ManyStarsTakeLittleTime) { EXPECT_FALSE(glob_matches("*a*a*a*a*a*a*a*a*a*a*b", std::string(5'000, 'a'))); }

}  // namespace
}  // namespace collided::wire_contract
