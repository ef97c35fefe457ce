#include "server/world/objects/tag_index.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

/// Keys are numbers too; some share a tag.
std::uint32_t tag_of_key(std::uint32_t key) { return key * 2'654'435'761u >> 20; }

// Grows, shrinks and moves entries over holes: always what a map has.
TEST(TagIndex, IsAMap) {
  std::mt19937_64 random = oracle::seeded(20261129);
  TagIndex index;
  std::map<std::uint32_t, std::uint32_t> twin;  // number by key
  std::vector<std::uint32_t> key_of;            // by number
  const auto find = [&](std::uint32_t key) {
    return index.find(tag_of_key(key), [&](std::uint32_t number) { return key_of[number] == key; });
  };
  for (const std::uint32_t most : {30u, 6'000u, 5u, 3'000u, 0u}) {
    for (int i = 0; i < 30'000; ++i) {
      const auto key = static_cast<std::uint32_t>(random() % 20'000);
      const auto known = twin.find(key);
      ASSERT_EQ(find(key), known == twin.end() ? TagIndex::kNone : known->second);
      if (known == twin.end() && twin.size() < most) {
        const auto number = static_cast<std::uint32_t>(key_of.size());
        key_of.push_back(key);
        index.add(tag_of_key(key), number);
        twin[key] = number;
      } else if (twin.size() > most || (known != twin.end() && random() % 2 == 0)) {
        const auto gone = known != twin.end() ? known : twin.begin();
        index.remove(tag_of_key(gone->first), gone->second);
        twin.erase(gone);
      } else if (known != twin.end()) {
        const auto number = static_cast<std::uint32_t>(key_of.size());
        key_of.push_back(key);
        index.renumber(tag_of_key(key), known->second, number);
        known->second = number;
      }
      ASSERT_EQ(index.size(), twin.size());
    }
    EXPECT_LE(twin.size(), most);
  }
}

}  // namespace
}  // namespace collided::engine
