#include <gtest/gtest.h>

#include "client/view/figures.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

/// The sums of a server that is up for so long and has done everything `times` times.
json figures(std::int64_t up_ns, std::uint64_t times) {
  const auto ns = [&](const char* stage, std::uint64_t each) { return json{{"stage", stage}, {"ns", each * times}}; };
  return {
      {"up_ns", up_ns},
      {"version", 18204},
      {"step_period_ns", 10'000'000},
      {"steps", 100 * times},
      {"stalled_steps", 0},
      {"step_durations", {{409'599, 99 * times}, {1'179'647, times}}},
      {"stages",
       {ns("take", 1'000'000), ns("update", 0), ns("index", 9'000'000), ns("test", 30'000'000),
        ns("publish", 10'000'000)}},
      {"pairs",
       {{"moved", 0},
        {"candidates", 31'200 * times},
        {"filtered", 104'400 * times},
        {"exact_tests", 0},
        {"undecided", 0},
        {"swept", 0},
        {"kept_apart", 0}}},
      {"poses",
       {{"applied", 960 * times},
        {"late", 0},
        {"unknown", 0},
        {"refused", 0},
        {"superseded", 2 * times},
        {"dropped", 0}}},
      {"stamps", {{"late", 0}, {"jumped", 0}, {"missing", 0}}},
      {"questions",
       {{{"kind", "ray"}, {"answered", 12'400 * times}, {"durations", {{17'407, 80 * times}, {61'439, 20 * times}}}},
        {{"kind", "box"}, {"answered", 0}, {"durations", json::array()}}}},
      {"refused", 0},
      {"undecided", 31 * times},
      {"not_built", {"FCL", "octree"}}};
}

class Top : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    ServerStatus& status = fake::server().status;
    status.version_text = "0.3";
    status.state = "ready";
    status.scenes = {"warehouse"};
    status.epoch = 6;
    status.pid = 4711;
    status.version = 18204;
    status.objects = 60;
    status.moving = 48;
    status.contacts = 7;
    status.publishers = {
        {.name = "walker", .applied_sequence = 9, .silent = std::chrono::milliseconds(12), .lost = false},
        {.name = "lift_plc", .applied_sequence = 9, .silent = std::chrono::seconds(4), .lost = false}};
    fake::server().command = [this](const std::string& name, const json&, const Shape&) -> Result<std::string> {
      EXPECT_EQ(name, "figures");
      const std::size_t look = std::min(looks++, readings.size() - 1);
      if (readings[look].is_null()) return Error{ErrorCode::disconnected, "silent", ""};
      return readings[look].dump();
    };
  }

  std::vector<json> readings{figures(5'000'000'000, 3), figures(6'000'000'000, 4)};
  std::size_t looks = 0;
};

// What was done before the first look does not count: rates and quantiles are of the second between.
TEST_F(Top, ShowsTheTimeBetweenTwoLooks) {
  const Ran ran = at_terminal("top --once --every 10ms");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "collided 0.3 · scene warehouse · up 6 s · world 18 204 · ready\n"
            "ASK    ray      12.4 k/s  p50 17.4 us  p99 61.4 us  |█|\n"
            "       undecided 0.25 %   refused 0\n"
            "POSES  60 objects, 48 moving   960/s   late 0   lost 2\n"
            "FROM   lift_plc silent, 4 s   walker 12 ms\n"
            "STAGE  take 2 %  update 0 %  index 18 %  test 60 %  publish 20 %   busy 5 %\n"
            "STEP   100/s   p50 410 us of 10 ms   p99 410 us\n"
            "PAIRS  candidates 312 a step   contacts 7   saved by filters 1 044\n"
            "NOT BUILT  FCL, octree\n");
}

// Clocks that do as clocks do take no room on the page.
TEST_F(Top, StampsThatWereTakenForOthersAreCounted) {
  readings[0]["stamps"] = {{"late", 2}, {"jumped", 0}, {"missing", 7}};
  readings[1]["stamps"] = {{"late", 5}, {"jumped", 1}, {"missing", 1'007}};
  const Ran ran = at_terminal("top --once --every 10ms");
  EXPECT_NE(ran.out.find("late 0   lost 2\nSTAMPS late 3   jumped 1   missing 1 000\nFROM   "), std::string::npos)
      << ran.out;
  looks = 0;
  const Ran records = collide("top --every 10ms --json");
  for (const char* line :
       {R"({"figure":"stamps.late","value":3,"unit":"1/s"})", R"({"figure":"stamps.jumped","value":1,"unit":"1/s"})",
        R"({"figure":"stamps.missing","value":1000,"unit":"1/s"})"}) {
    EXPECT_NE(records.out.find(std::string(line) + "\n"), std::string::npos) << line << "\n" << records.out;
  }
}

TEST_F(Top, MachinesGetOneSetOfRecords) {
  const Ran ran = collide("top --every 10ms --json");
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const char* line :
       {R"({"figure":"ask.ray.rate","value":12400,"unit":"1/s"})",
        R"({"figure":"ask.ray.p99","value":6.1439e-05,"unit":"s"})",
        R"({"figure":"ask.box.rate","value":0,"unit":"1/s"})", R"({"figure":"ask.box.p50","unit":"s"})",
        R"({"figure":"pairs.filtered","value":1044,"unit":"a step"})",
        R"({"figure":"silent.lift_plc","value":4,"unit":"s"})"}) {
    EXPECT_NE(ran.out.find(std::string(line) + "\n"), std::string::npos) << line << "\n" << ran.out;
  }
  EXPECT_EQ(looks, 2U);
}

TEST_F(Top, RefreshesItsOwnScreenAndGivesTheOldOneBack) {
  const Ran ran = at_terminal("top -n 2 --every 10ms");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out.rfind("\x1b[?1049h", 0), 0U);
  const std::size_t given_back = ran.out.find("\x1b[?25h\x1b[?1049l");
  ASSERT_NE(given_back, std::string::npos);
  const std::string left = ran.out.substr(given_back + 14);
  EXPECT_TRUE(left.starts_with("collided ")) << "the last figures stay: " << left;
  EXPECT_EQ(left.find('\x1b'), std::string::npos);
  std::size_t shown = 0;
  for (std::size_t at = ran.out.find("\x1b[H"); at != std::string::npos; at = ran.out.find("\x1b[H", at + 1)) ++shown;
  EXPECT_EQ(shown, 2U);
}

// A line that wraps would push the page out of place.
TEST_F(Top, NoLineIsWiderThanTheTerminal) {
  fake::server().status.scenes = {std::string(200, 'x')};
  const Ran ran = at_terminal("top -n 1 --every 10ms", 80);
  const std::size_t begin = ran.out.find("\x1b[H") + 3;
  const std::string first = ran.out.substr(begin, ran.out.find("\x1b[K", begin) - begin);
  std::size_t columns = 0;
  for (const char c : first) columns += (static_cast<unsigned char>(c) & 0xc0) != 0x80 ? 1 : 0;
  EXPECT_EQ(columns, 80U) << first;
}

// "test 60 %" cut to "test 6" would be another figure.
TEST_F(Top, ALineIsCutBetweenItsWords) {
  const Ran ran = at_terminal("top -n 1 --every 10ms", 44);
  EXPECT_NE(ran.out.find("STAGE  take 2 %  update 0 %  index 18 %…\n"), std::string::npos) << ran.out;
}

TEST_F(Top, AServerThatFallsSilentIsSaidSo) {
  readings[1] = nullptr;
  const Ran live = at_terminal("top -n 1 --every 10ms");
  EXPECT_EQ(live.code, 0);
  EXPECT_NE(live.out.find("no server answers, since "), std::string::npos) << live.out;
  looks = 0;
  EXPECT_EQ(collide("top --once --every 10ms").code, 4);
}

TEST_F(Top, AServerStartedAnewIsSaidSoAndItsSumsBeginAtNothing) {
  readings[1] = figures(1'000'000'000, 1);
  fake::server().command = [this](const std::string&, const json&, const Shape&) -> Result<std::string> {
    if (looks == 1) fake::server().status.epoch = 7;
    return readings[looks++].dump();
  };
  const Ran ran = at_terminal("top -n 1 --every 10ms");
  EXPECT_NE(ran.out.find("the server was started anew: epoch 7 after 6, pid 4711"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("12.4 k/s"), std::string::npos) << ran.out;
}

TEST_F(Top, AnAnswerFromElsewhereIsRefused) {
  for (const json& reading :
       {json::object(), json::array(), json{{"up_ns", "a"}}, json{{"up_ns", 1}, {"step_durations", {{1}}}}}) {
    looks = 0;
    readings[0] = reading;
    EXPECT_EQ(collide("top --once --every 10ms").code, 5) << reading;
  }
}

// A56: each of the newest steps with its stages and the whole.
TEST_F(Top, StepsAreShownStageByStage) {
  const auto step = [](std::uint64_t version) {
    return json{{"version", version},  {"world_time_ns", 5}, {"whole_ns", 21'000}, {"take_ns", 1'000},
                {"update_ns", 2'000},  {"index_ns", 3'000},  {"test_ns", 4'000},   {"events_ns", 5'000},
                {"publish_ns", 6'000}, {"moved", 7},         {"candidates", 8},    {"exact_tests", 9},
                {"contacts", 10},      {"events", 11}};
  };
  json asked;
  fake::server().command = [&](const std::string& name, const json& arguments, const Shape&) -> Result<std::string> {
    asked = {name, arguments.at("last")};
    return json{{"steps", {step(41), step(42)}}}.dump();
  };
  const Ran piped = collide("top --steps 2");
  EXPECT_EQ(piped.code, 0) << piped.err;
  EXPECT_EQ(asked, json({"steps", 2}));
  EXPECT_EQ(piped.out,
            "41\t5\t1000\t2000\t3000\t4000\t5000\t6000\t21000\t7\t8\t9\t10\t11\n"
            "42\t5\t1000\t2000\t3000\t4000\t5000\t6000\t21000\t7\t8\t9\t10\t11\n");
  const Ran ran = at_terminal("top --steps 2");
  EXPECT_NE(ran.out.find("WHOLE"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("21 us"), std::string::npos) << ran.out;
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return json{{"steps", json::array()}}.dump();
  };
  EXPECT_EQ(collide("top --steps 2").code, 1) << "nothing has moved yet";
  EXPECT_EQ(collide("top --steps 0").code, 2);
}

// The median of 1..1000 us and the like: at most an eighth too long is what the steps allow; here they are given exactly.
TEST(TopQuantiles, AreTheLeastThatThePartDoesNotExceed) {
  const std::vector<view::DurationStep> durations{{10, 50}, {20, 49}, {30, 1}};
  EXPECT_EQ(view::quantile_ns(durations, 0.5), 10);
  EXPECT_EQ(view::quantile_ns(durations, 0.51), 20);
  EXPECT_EQ(view::quantile_ns(durations, 0.99), 20);
  EXPECT_EQ(view::quantile_ns(durations, 1), 30);
  EXPECT_EQ(view::quantile_ns({}, 0.5), std::nullopt);
}

}  // namespace
}  // namespace collided
