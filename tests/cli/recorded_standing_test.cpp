// What an explanation from a recording takes from the recording itself: what was told until then.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/cli/verbs/recorded_standing.hpp"
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

json row(const char* object, double clearance_m, bool is_told = false) {
  json told{{"object", object}, {"answer", clearance_m > 0 ? "outside" : "inside"}, {"clearance", clearance_m}};
  // As a replay that began a moment ago has it.
  if (is_told) told.update({{"told", true}, {"since_ns", 7}, {"episode", 1}, {"doubt", ""}});
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
  const json fresh{
      {"fence", "dock"},           {"inside", {row("drone", -0.5, true)}},  {"outside", {row("crate", 0.1)}},
      {"left_out", json::array()}, {"asked_for", row("drone", -0.5, true)}, {"events", {{{"sequence", 1}}}}};
  json then = fresh;
  put_recorded_news_of_fence(then, file_.path(), s(102));
  const json drone = then.at("inside").at(0);
  EXPECT_EQ(drone.at("since_ns"), s(100.999).count());
  EXPECT_EQ(drone.at("episode"), 7);
  EXPECT_EQ(then.at("asked_for"), drone);
  // It had been told of before the recording; that it stands outside now is another thing.
  EXPECT_EQ(then.at("outside").at(0).at("since_ns"), s(90).count());
  EXPECT_EQ(then.at("events"), json::parse(R"([{"sequence":7,"what":"enter","object":"drone","why":"","doubt":"",
      "low_ns":100998000000,"high_ns":100999000000}])"));

  json at_end = fresh;
  put_recorded_news_of_fence(at_end, file_.path(), std::chrono::nanoseconds::max());
  EXPECT_FALSE(at_end.at("inside").at(0).contains("told"));
  EXPECT_FALSE(at_end.at("inside").at(0).contains("since_ns"));
  ASSERT_EQ(at_end.at("events").size(), 2U);
  EXPECT_EQ(at_end.at("events").at(1).at("what"), "exit");
  EXPECT_EQ(at_end.at("events").at(1).at("why"), "separated");
  EXPECT_EQ(at_end.at("events").at(1).at("sequence"), 9);
}

// With a hysteresis another one may be nearer; the recording says who was told.
TEST_F(RecordedStanding, OfAQuestionIsWhoWasNearestThen) {
  const json fresh{{"nearest", "next"},
                   {"is", {row("drone", 1, true)}},
                   {"others", {row("crate", 1.5), row("van", 2), row("bus", 3)}},
                   {"left_out", json::array()},
                   {"events", json::array()},
                   {"cut_short", 4}};
  json then = fresh;
  put_recorded_news_of_nearest(then, file_.path(), s(103), 2);
  ASSERT_EQ(then.at("is").size(), 1U);
  EXPECT_EQ(then.at("is").at(0).at("object"), "crate");
  EXPECT_EQ(then.at("is").at(0).at("since_ns"), s(102).count());
  ASSERT_EQ(then.at("others").size(), 2U);
  EXPECT_EQ(then.at("others").at(0).at("object"), "drone");
  EXPECT_FALSE(then.at("others").at(0).contains("told"));
  EXPECT_EQ(then.at("others").at(1).at("object"), "van");
  EXPECT_FALSE(then.contains("cut_short")) << "of the replay";

  json at_end = fresh;
  put_recorded_news_of_nearest(at_end, file_.path(), std::chrono::nanoseconds::max(), 3);
  EXPECT_EQ(at_end.at("is").at(0).at("object"), "drone");
  EXPECT_EQ(at_end.at("others").size(), 3U);
  EXPECT_EQ(at_end.at("is").at(0).at("since_ns"), s(104).count());
  std::vector<std::string> told;
  for (const json& event : at_end.at("events"))
    told.push_back(event.at("what").get<std::string>() + ' ' + event.at("object").get<std::string>() + ' ' +
                   event.at("why").get<std::string>() + ' ' + event.at("sequence").dump());
  EXPECT_EQ(told, (std::vector<std::string>{"nearest crate  8", "no longer nearest crate separated 10",
                                            "nearest drone  11"}));

  json before = fresh;
  put_recorded_news_of_nearest(before, file_.path(), s(101), 3);
  EXPECT_TRUE(before.at("is").empty()) << "nothing was told yet";
  EXPECT_EQ(before.at("others").at(0).at("object"), "drone");
  EXPECT_TRUE(before.at("events").empty());
}

}  // namespace
}  // namespace collided::cli
