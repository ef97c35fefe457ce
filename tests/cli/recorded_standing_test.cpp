// What an explanation from a recording takes from the recording itself: what was told until then.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/cli/verbs/recorded_standing.hpp"
#include "idl/answers/explanation.hpp"
#include "idl/described_json.hpp"
#include "idl/fence_ids.hpp"
#include "tests/cli/fakes/event_recording.hpp"
#include "tests/cli/scratch_file.hpp"

namespace collided::cli {
namespace {

using nlohmann::json;
using test::EventRecording;
using Kind = EventRecording::Kind;
using Reason = EventRecording::Reason;

constexpr std::uint64_t kFence = std::uint64_t{1} << 63;
constexpr std::uint64_t kDrone = 1, kCrate = 2, kDock = kFence | 3, kGate = kFence | 4;
constexpr std::uint64_t kNext = wire_contract::kNearestBits | 5;

std::chrono::nanoseconds s(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

ExplainedStanding standing(const char* object, double clearance_m, bool is_told = false) {
  ExplainedStanding told{.object = object,
                         .verdict = clearance_m > 0 ? Verdict::miss : Verdict::hit,
                         .clearance_m = clearance_m,
                         .told = is_told};
  // As a replay that began a moment ago has it.
  if (is_told) told.since = std::chrono::nanoseconds(7);
  if (is_told) told.episode = 1;
  return told;
}

class RecordedStanding : public testing::Test {
 protected:
  RecordedStanding() {
    EventRecording run(file_.path());
    run.begin_life(9);
    run.name(kDrone, "drone");
    run.name(kCrate, "crate");
    run.name(kDock, "dock");
    run.name(kGate, "gate");
    run.name(kNext, "next");
    run.tell_of_fences(true);
    run.shard(100, 5, {{kCrate, kDock, 5, 90}});
    run.status(100.1, 5, {{kCrate, kDock, 5, 90}});
    run.frame(101, 6, {{Kind::began, kDrone, kGate, 6}, {Kind::began, kDrone, kDock, 7, 0.002, 0.001}});
    run.frame(102, 8, {{Kind::began, kCrate, kNext, 8}});
    run.frame(103, 9, {{Kind::ended, kDrone, kDock, 7, 0.004, 0.003, Reason::separated}});
    run.frame(104, 10, {{Kind::ended, kCrate, kNext, 8, 0, 0, Reason::separated}});
    run.frame(104, 11, {{Kind::began, kDrone, kNext, 11}});
    run.status(105, 11, {{kCrate, kDock, 5, 90}, {kDrone, kGate, 6, 101}, {kDrone, kNext, 11, 104}});
  }

  ScratchFile file_{"standing.mcap", ""};
};

TEST_F(RecordedStanding, OfAFenceIsWhoWasInThenAndWhatWasTold) {
  const ExplainedFence fresh{.fence = "dock",
                             .inside = {standing("drone", -0.5, true)},
                             .outside = {standing("crate", 0.1)},
                             .asked_for = standing("drone", -0.5, true),
                             .events = {{.sequence = 1}}};
  ExplainedFence then = fresh;
  put_recorded_news(then, file_.path(), s(102));
  const ExplainedStanding& drone = then.inside.at(0);
  EXPECT_TRUE(drone.told);
  EXPECT_EQ(drone.since, s(100.999));
  EXPECT_EQ(drone.episode, 7U);
  EXPECT_EQ(json_of(*then.asked_for), json_of(drone));
  // It had been told of before the recording; that it stands outside now is another thing.
  EXPECT_EQ(then.outside.at(0).since, s(90));
  EXPECT_EQ(json_of(then.events), json::parse(R"([{"sequence":7,"what":"enter","object":"drone","why":"","doubt":"",
      "low_ns":100998000000,"high_ns":100999000000}])"));

  ExplainedFence at_end = fresh;
  put_recorded_news(at_end, file_.path(), std::chrono::nanoseconds::max());
  EXPECT_FALSE(at_end.inside.at(0).told);
  EXPECT_FALSE(at_end.inside.at(0).since);
  ASSERT_EQ(at_end.events.size(), 2U);
  EXPECT_EQ(at_end.events.at(1).what, "exit");
  EXPECT_EQ(at_end.events.at(1).why, "separated");
  EXPECT_EQ(at_end.events.at(1).sequence, 9U);
}

// With a hysteresis another one may be nearer; the recording says who was told.
TEST_F(RecordedStanding, OfAQuestionIsWhoWasNearestThen) {
  const ExplainedNearest fresh{.nearest = "next",
                               .is = standing("drone", 1, true),
                               .others = {standing("crate", 1.5), standing("van", 2), standing("bus", 3)},
                               .cut_short = 4};
  ExplainedNearest then = fresh;
  put_recorded_news(then, file_.path(), s(103), 2);
  ASSERT_TRUE(then.is);
  EXPECT_EQ(then.is->object, "crate");
  EXPECT_EQ(then.is->since, s(102));
  ASSERT_EQ(then.others.size(), 2U);
  EXPECT_EQ(then.others.at(0).object, "drone");
  EXPECT_FALSE(then.others.at(0).told);
  EXPECT_EQ(then.others.at(1).object, "van");
  EXPECT_EQ(then.cut_short, 0U) << "of the replay";

  ExplainedNearest at_end = fresh;
  put_recorded_news(at_end, file_.path(), std::chrono::nanoseconds::max(), 3);
  ASSERT_TRUE(at_end.is);
  EXPECT_EQ(at_end.is->object, "drone");
  EXPECT_EQ(at_end.others.size(), 3U);
  EXPECT_EQ(at_end.is->since, s(104));
  std::vector<std::string> told;
  for (const ExplainedNews& event : at_end.events)
    told.push_back(event.what + ' ' + event.object + ' ' + event.why + ' ' + std::to_string(event.sequence));
  EXPECT_EQ(told, (std::vector<std::string>{"nearest crate  8", "no longer nearest crate separated 10",
                                            "nearest drone  11"}));

  ExplainedNearest before = fresh;
  put_recorded_news(before, file_.path(), s(101), 3);
  EXPECT_FALSE(before.is) << "nothing was told yet";
  EXPECT_EQ(before.others.at(0).object, "drone");
  EXPECT_TRUE(before.events.empty());
}

}  // namespace
}  // namespace collided::cli
