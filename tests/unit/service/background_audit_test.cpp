// One answer in so many is worked out again, each on the state that it was given on.
#include "server/service/questions/background_audit.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <future>

#include "server/world/world.hpp"
#include "tests/service/eventually.hpp"

namespace collided::engine::service {
namespace {

class ServiceBackgroundAudit : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* const name : {"left", "right"}) {
      ObjectDefinition ball;
      ball.name = name;
      ball.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
      ball.pose.position = {name[0] == 'l' ? 0. : 10., 0, 0};
      id = std::get<ObjectId>(world.define(ball));
    }
    step();
  }
  void step() { world.step(++time_ns, 1, {}); }
  /// Balls about the two objects and one about nothing, so many times; each with its own hits.
  void ask(int times = 1, std::string_view only = {}, std::string_view skip = {}) {
    numbers.clear();
    for (int i = 0; i < times; ++i) numbers.insert(numbers.end(), {0, 0, 0, 1, 50, 0, 0, 1, 10, 0, 0, 1});
    asked = {.kind = QuestionKind::sphere, .only = only, .skip = skip, .numbers = numbers};
    state = world.newest();
    answer(*state, asked, given, scratch);
  }
  /// That nothing is where the first ball is.
  void lie() {
    ASSERT_EQ(given.hit_counts[0], 1U);
    given.answers[0] = Verdict::miss;
    given.hits.erase(given.hits.begin());
    given.hit_counts[0] = 0;
  }
  static bool has_audited(const BackgroundAudit& audit, std::uint64_t count) {
    return test::eventually([&] { return audit.counts().audited == count; });
  }

  World world{WorldOptions{}};
  ObjectId id = 0;
  std::int64_t time_ns = 0;
  std::vector<double> numbers;
  Questions asked;
  Answers given;
  QueryScratch scratch;
  SnapshotRing::Lease state;
};

TEST_F(ServiceBackgroundAudit, WithoutAnAuditNothingIsChosen) {
  BackgroundAudit audit(0, {});
  ask();
  audit.consider(state, asked, given);
  EXPECT_EQ(audit.every(), 0U);
  EXPECT_EQ(audit.counts().chosen, 0U);
  EXPECT_EQ(audit.counts().skipped, 0U);
}

// Whole batches count on from each other: of answers 0, 1, 2, ... those that 4 divides.
TEST_F(ServiceBackgroundAudit, TheFirstAndThenEachOneInSoManyIsChosen) {
  BackgroundAudit audit(4, {});
  ask();  // three answers
  std::uint64_t chosen = 0;
  for (std::uint64_t first = 0; first < 24; first += 3) {
    for (std::uint64_t i = first; i < first + 3; ++i) chosen += i % 4 == 0 ? 1 : 0;
    audit.consider(state, asked, given);
    EXPECT_EQ(audit.counts().chosen, chosen) << first;
  }
  EXPECT_TRUE(has_audited(audit, chosen));
  ask(3);  // nine at once: the answers 24 to 32
  audit.consider(state, asked, given);
  EXPECT_EQ(audit.counts().chosen, chosen + 3);
  EXPECT_TRUE(has_audited(audit, chosen + 3));
  EXPECT_EQ(audit.counts().differing, 0U);
  EXPECT_EQ(audit.counts().skipped, 0U);
}

// Each chosen answer takes its own numbers and hits along, and what its question left out; the memory that they were in is
// used again at once.
TEST_F(ServiceBackgroundAudit, AnAnswerIsComparedWithItsOwnQuestion) {
  BackgroundAudit audit(1, {});
  for (const auto& [only, skip] :
       {std::pair("", ""), std::pair("right", ""), std::pair("", "ri*"), std::pair("l*", "left")}) {
    std::string only_here = only, skip_here = skip;
    ask(2, only_here, skip_here);
    audit.consider(state, asked, given);
    only_here.assign(only_here.size(), '?');
    skip_here.assign(skip_here.size(), '?');
    std::fill(numbers.begin(), numbers.end(), 7);
    given = {};
  }
  EXPECT_TRUE(has_audited(audit, 4 * 6));
  EXPECT_EQ(audit.differences(), std::vector<std::string>{});
}

#ifdef COLLIDED_OPINION_BUILT
// Of three balls two meet an object and the third meets nothing, which FCL is not asked about. FCL sees a lie as the rationals do.
TEST_F(ServiceBackgroundAudit, FclIsAskedTooWhereThatIsWanted) {
  ::setenv("COLLIDED_OPINION_PROGRAM", COLLIDED_OPINION_BUILT, 1);
  BackgroundAudit audit(
      1, [](const std::string&) {}, true);
  ask();
  audit.consider(state, asked, given);
  EXPECT_TRUE(has_audited(audit, 3));
  EXPECT_EQ(audit.counts().opinion.agree, 2U);
  EXPECT_EQ(audit.counts().opinion.unsupported, 1U);
  EXPECT_EQ(audit.differences(), std::vector<std::string>{});
  lie();
  audit.consider(state, asked, given);
  EXPECT_TRUE(has_audited(audit, 6));
  EXPECT_EQ(audit.counts().opinion.differ, 1U);
  EXPECT_EQ(audit.counts().differing, 1U) << "FCL's word is counted apart";
  const std::vector<std::string> differences = audit.differences();
  ASSERT_EQ(differences.size(), 2U);
  EXPECT_NE(differences[0].find("FCL says that something is touched, answered was a miss"), std::string::npos)
      << differences[0];
  ::unsetenv("COLLIDED_OPINION_PROGRAM");
}
#endif

TEST_F(ServiceBackgroundAudit, EveryDifferenceIsCountedAndTheFirst16AreTold) {
  std::vector<std::string> told;  // by the auditing thread alone, until it has ended
  BackgroundAudit audit(1, [&](const std::string& sentence) { told.push_back(sentence); });
  ask();
  lie();
  for (int i = 0; i < 20; ++i) audit.consider(state, asked, given);
  EXPECT_TRUE(has_audited(audit, 60));
  EXPECT_EQ(audit.counts().differing, 20U);
  const std::vector<std::string> differences = audit.differences();
  audit.stop();
  ASSERT_EQ(differences.size(), 16U);
  ASSERT_EQ(told.size(), 16U);
  EXPECT_EQ(told[3], "audit: an answer of world " + std::to_string(state->version) + " differs: " + differences[3]);
  EXPECT_NE(differences[3], "");
}

// While the auditor is busy the world goes on: an answer is compared with the state that it is of, not with one that is kept
// already. Four states are kept; an answer of a fifth is skipped, and said to be.
TEST_F(ServiceBackgroundAudit, AnAnswerIsComparedWithItsOwnState) {
  std::promise<void> told, may_go_on;
  BackgroundAudit audit(1, [&, first = true](const std::string&) mutable {
    if (!std::exchange(first, false)) return;
    told.set_value();
    may_go_on.get_future().wait();
  });
  ask();
  lie();
  audit.consider(state, asked, given);
  ASSERT_EQ(told.get_future().wait_for(std::chrono::seconds(10)), std::future_status::ready);
  ask();
  audit.consider(state, asked, given);  // of the state that is kept for the first
  for (int i = 1; i < 5; ++i) {
    world.move(id, {.position = {10. * (1 + i), 0, 0}}, time_ns, true);
    step();
    ask();
    audit.consider(state, asked, given);
  }
  may_go_on.set_value();
  EXPECT_TRUE(has_audited(audit, 3 * 5));
  EXPECT_EQ(audit.counts().chosen, 3U * 6);
  EXPECT_EQ(audit.counts().skipped, 3U);
  EXPECT_EQ(audit.counts().differing, 1U);
}

}  // namespace
}  // namespace collided::engine::service
