// What an explanation from a recording takes from the recording itself: what was reported until then.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/cli/verbs/recorded_standing.hpp"
#include "idl/answers/explanation.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/event_recording.hpp"
#include "tests/cli/scratch_file.hpp"

namespace collided::cli {
namespace {

using nlohmann::json;
using test::EventRecording;
using test::StandingStay;
using Kind = codes::StandingEventKind;
using Reason = EventRecording::Reason;

constexpr std::uint64_t kDrone = 1, kCrate = 2;
constexpr std::uint64_t kDock = test::standing_id(3), kGate = test::standing_id(4), kNext = test::standing_id(5);

std::chrono::nanoseconds s(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

ExplainedObject standing(const char* object, double clearance_m, bool is_reported = false) {
  ExplainedObject explained{.object = object,
                            .verdict = clearance_m > 0 ? Verdict::miss : Verdict::hit,
                            .clearance_m = clearance_m,
                            .reported = is_reported};
  // As a replay that began a moment ago has it.
  if (is_reported) explained.since = std::chrono::nanoseconds(7);
  if (is_reported) explained.episode = 1;
  return explained;
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
    const StandingStay crate{.standing = kDock, .object = kCrate, .episode = 5, .began_ns = 90'000'000'000};
    run.standing_shard(100, 5, {crate});
    run.standing_sum(100.1, 5, {crate});
    run.standing_frame(101, 6,
                       {{.kind = Kind::enter, .standing = kGate, .object = kDrone, .episode = 6},
                        {.kind = Kind::enter,
                         .standing = kDock,
                         .object = kDrone,
                         .episode = 7,
                         .bracket_low_s = 0.002,
                         .bracket_high_s = 0.001}});
    run.standing_frame(102, 8, {{.kind = Kind::changed, .standing = kNext, .object = kCrate}});
    run.standing_frame(103, 9,
                       {{.kind = Kind::exit,
                         .standing = kDock,
                         .object = kDrone,
                         .episode = 7,
                         .reason = Reason::separated,
                         .bracket_low_s = 0.004,
                         .bracket_high_s = 0.003}});
    run.standing_frame(
        104, 10,
        {{.kind = Kind::changed, .standing = kNext, .other = kCrate, .episode = 8, .reason = Reason::separated},
         {.kind = Kind::changed, .standing = kNext, .object = kDrone}});
    run.standing_sum(105, 11,
                     {crate,
                      {.standing = kGate, .object = kDrone, .episode = 6},
                      {.form = StandingForm::nearest, .standing = kNext, .object = kDrone, .episode = 11}});
  }

  ScratchFile file_{"standing.mcap", ""};
};

TEST_F(RecordedStanding, OfARegionIsWhatWasInThenAndWhatWasReported) {
  ExplainedStanding fresh;
  fresh.name = "dock";
  fresh.holds = {standing("drone", -0.5, true)};
  fresh.others = {standing("crate", 0.1), standing("van", 3)};
  fresh.asked_for = standing("drone", -0.5, true);
  fresh.events = {{.sequence = 1}};
  ExplainedStanding then = fresh;
  put_recorded_news(then, file_.path(), s(102), 1);
  const ExplainedObject& drone = then.holds.at(0);
  EXPECT_TRUE(drone.reported);
  EXPECT_EQ(drone.since, s(100.999));
  EXPECT_EQ(drone.episode, 7U);
  EXPECT_EQ(json_of(*then.asked_for), json_of(drone));
  ASSERT_EQ(then.others.size(), 1U);
  EXPECT_EQ(then.others.at(0).since, s(90)) << "reported before the recording; that it is outside now is another thing";
  EXPECT_EQ(json_of(then.events), json::parse(R"([{"sequence":7,"what":"enter","object":"drone","why":"","doubt":"",
      "low_ns":100998000000,"high_ns":100999000000}])"));

  ExplainedStanding at_end = fresh;
  put_recorded_news(at_end, file_.path(), std::chrono::nanoseconds::max(), 3);
  EXPECT_FALSE(at_end.holds.at(0).reported);
  EXPECT_FALSE(at_end.holds.at(0).since);
  ASSERT_EQ(at_end.events.size(), 2U);
  EXPECT_EQ(at_end.events.at(1).what, "exit");
  EXPECT_EQ(at_end.events.at(1).why, "separated");
  EXPECT_EQ(at_end.events.at(1).sequence, 9U);
}

// With a hysteresis another one may be nearer; the recording says which was reported.
TEST_F(RecordedStanding, OfTheNearestIsWhichWasNearestThen) {
  ExplainedStanding fresh;
  fresh.name = "next";
  fresh.form = StandingForm::nearest;
  fresh.holds = {standing("drone", 1, true)};
  fresh.others = {standing("crate", 1.5), standing("van", 2), standing("bus", 3)};
  fresh.cut_short = 4;
  ExplainedStanding then = fresh;
  put_recorded_news(then, file_.path(), s(103), 2);
  ASSERT_EQ(then.holds.size(), 1U);
  EXPECT_EQ(then.holds.at(0).object, "crate");
  EXPECT_EQ(then.holds.at(0).since, s(102));
  ASSERT_EQ(then.others.size(), 2U);
  EXPECT_EQ(then.others.at(0).object, "drone");
  EXPECT_FALSE(then.others.at(0).reported);
  EXPECT_EQ(then.others.at(1).object, "van");
  EXPECT_EQ(then.cut_short, 0U) << "of the replay";

  ExplainedStanding at_end = fresh;
  put_recorded_news(at_end, file_.path(), std::chrono::nanoseconds::max(), 3);
  ASSERT_EQ(at_end.holds.size(), 1U);
  EXPECT_EQ(at_end.holds.at(0).object, "drone");
  EXPECT_EQ(at_end.others.size(), 3U);
  EXPECT_EQ(at_end.holds.at(0).since, s(104));
  std::vector<std::string> reported;
  for (const ExplainedNews& event : at_end.events)
    reported.push_back(event.what + ' ' + event.object + ' ' + event.why + ' ' + std::to_string(event.sequence));
  EXPECT_EQ(reported, (std::vector<std::string>{"nearest crate  8", "no longer nearest crate separated 10",
                                                "nearest drone  11"}));

  ExplainedStanding before = fresh;
  put_recorded_news(before, file_.path(), s(101), 3);
  EXPECT_TRUE(before.holds.empty()) << "none was reported yet";
  EXPECT_EQ(before.others.at(0).object, "drone");
  EXPECT_TRUE(before.events.empty());
}

}  // namespace
}  // namespace collided::cli
