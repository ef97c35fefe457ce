// What a primary's commands do reaches those that follow, in order and without a gap, however much it keeps.
#include "server/fleet/change_feed.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/own_domain.hpp"

namespace collided::engine::service {
namespace {

// All that is kept takes more places than changes may wait for.
TEST(ChangeFeed, AChangeBehindMuchThatIsKeptIsNotLost) {
  constexpr std::uint64_t kFollower = 9;
  constexpr std::size_t kKept = 20'000;
  const dds::Participant participant({.domain = testing_support::own_domain()});
  const dds::Topic<wire::Change> topic(participant, "feed");
  dds::Reader<wire::Change> reader(topic);
  ChangeFeed feed(participant, 1, "feed");
  ASSERT_TRUE(test::eventually([&] { return feed.is_followed() && reader.matched_writers() > 0; }));
  feed.tell({.text = "before", .blob = {}});
  feed.tell_all(kFollower, 1, std::vector<WorldChange>(kKept, {.text = "kept", .blob = {}}));
  for (int i = 0; i < 10; ++i) feed.tell({.text = "after", .blob = {}});
  std::vector<std::uint64_t> live;
  std::size_t kept = 0;
  dds::Sample<wire::Change> sample;
  const auto take = [&] {
    while (reader.take(sample)) {
      if (!sample.info().valid_data) continue;
      if (sample->follower == kFollower) ++kept;
      else live.push_back(sample->sequence_number);
    }
    return kept == kKept && live.size() == 11;
  };
  EXPECT_TRUE(test::eventually(take, std::chrono::seconds(60))) << kept << " kept, " << live.size() << " live";
  for (std::size_t i = 0; i < live.size(); ++i) EXPECT_EQ(live[i], i + 1);
}

}  // namespace
}  // namespace collided::engine::service
