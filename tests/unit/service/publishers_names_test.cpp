// Names and numbers of objects, and what becomes of bad definitions.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include "tests/unit/service/publishers_fixture.hpp"

namespace collided::engine::service {
namespace {

TEST_F(PublishersTest, TheFirstKeepsItsNameAndTheSecondWaits) {
  define(definition(1, 1, "ball"));
  DefinitionSample second = definition(1, 1, "ball", 5);
  second.publisher = 8;
  define(second);
  step();
  EXPECT_EQ(height("ball"), 3);
  EXPECT_EQ(publishers.counts().name_conflicts, 1U);
  EXPECT_EQ(publishers.waiting_for("ball"), std::vector<std::uint64_t>{8});
  define(removal(1, 2));
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(height("ball"), 5);
  EXPECT_TRUE(publishers.waiting_for("ball").empty());
}

// A program that restarts is another publisher; what the dead one has frozen makes room at once.

TEST_F(PublishersTest, ANewIncarnationStartsEmpty) {
  define(definition(1, 10, "old"));
  step();
  DefinitionSample fresh = definition(2, 1, "new");
  fresh.incarnation = 2;
  define(fresh);
  move(pose(11, {{1, 9}}));  // of the earlier incarnation
  step();
  EXPECT_FALSE(world.find("old"));
  EXPECT_EQ(height("new"), 3);
  EXPECT_EQ(publishers.counts().poses_late, 1U);
}

TEST_F(PublishersTest, PublishersAndNumbersAreBounded) {
  for (std::uint64_t publisher = 1; publisher <= 5; ++publisher) {
    DefinitionSample sample =
        definition(1, 1, "ball" + std::to_string(publisher), 2.0 * static_cast<double>(publisher));
    sample.publisher = publisher;
    define(sample);
  }
  EXPECT_EQ(publishers.size(), 3U);
  EXPECT_EQ(publishers.counts().publishers_refused, 2U);
  for (std::uint32_t number = 2; number < 40; ++number) {
    DefinitionSample sample = definition(number << 20, number, "n" + std::to_string(number), 2.0 * number);
    sample.publisher = 1;
    define(sample);
  }
  EXPECT_EQ(publishers.counts().definitions_refused, 21U);  // 38 offered, 17 of 20 numbers were free
}

TEST_F(PublishersTest, BadDefinitionsLeaveWhatIsThere) {
  define(definition(1, 1, "ball"));
  DefinitionSample bad = definition(1, 2, std::string("ba\xffll"));
  define(bad);
  bad = definition(1, 3, "ball");
  bad.lost_policy = 3;
  define(bad);
  bad = definition(1, 4, "ball");
  bad.shape = Refusal{"sphere 0: radius -1"};
  define(bad);
  bad = definition(1, 5, "ball");
  bad.pose[0] = std::numeric_limits<double>::infinity();
  define(bad);
  step();
  EXPECT_EQ(publishers.counts().definitions_refused, 4U);
  EXPECT_EQ(height("ball"), 3);
}

TEST_F(PublishersTest, ARestartGivesItsObjectNumbersBack) {
  for (std::uint64_t life = 1; life <= 5; ++life) {
    for (std::uint32_t number = 1; number <= 10; ++number) {
      DefinitionSample sample = definition(number, number, "n" + std::to_string(number), 2.0 * number);
      sample.incarnation = life;
      define(sample);
    }
    step();
  }
  EXPECT_EQ(publishers.counts().definitions_refused, 0U);
}

TEST_F(PublishersTest, AnObjectThatWasRemovedLeavesItsNameAndNumberToTheNext) {
  define(definition(1, 1, "ball"));
  step();
  define(removal(1, 2));
  define(definition(1, 3, "box", 4));
  define(definition(2, 4, "ball", 6));
  step();
  EXPECT_EQ(height("box"), 4);
  EXPECT_EQ(height("ball"), 6);
  EXPECT_EQ(publishers.counts().name_conflicts, 0U);
}

TEST_F(PublishersTest, EveryPublisherIsShownWithItsNameAndSilence) {
  define(definition(1, 1, "ball"));
  DefinitionSample other = definition(1, 1, "box", 5);
  other.publisher = 8;
  other.publisher_name = "arm";
  now_ns += 500;
  define(other);
  step();
  std::vector<std::pair<std::string, std::int64_t>> shown;
  const std::int64_t reported_ns = now_ns - 1;
  publishers.for_each(reported_ns + 100, [&](const PublisherView& view) {
    EXPECT_EQ(view.publisher, shown.empty() ? kPublisher : 8U);
    shown.emplace_back(view.name, view.silent_ns);
  });
  EXPECT_EQ(shown, (std::vector<std::pair<std::string, std::int64_t>>{{"test", 600}, {"arm", 100}}));
}

// Definitions of two objects may come in either order: what has been seen is the newest of them.

}  // namespace
}  // namespace collided::engine::service
