#include <gtest/gtest.h>

#include "client/cli/output/top_keys.hpp"
#include "client/cli/output/wrapping.hpp"
#include "client/view/figures.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

/// The sums of a server that is up for so long and has done everything `times` times.
json figures(std::int64_t up_ns, std::uint64_t times) {
  return json_of(
      Figures{.up_ns = up_ns,
              .version = 18204,
              .step_period_ns = 10'000'000,
              .steps = 100 * times,
              .step_durations = {{409'599, 99 * times}, {1'179'647, times}},
              .stages = {{"take", 1'000'000 * times},
                         {"update", 0},
                         {"index", 9'000'000 * times},
                         {"test", 30'000'000 * times},
                         {"publish", 10'000'000 * times}},
              .pairs = {.candidates = 31'200 * times, .filtered = 104'400 * times},
              .poses = {.applied = 960 * times, .superseded = 2 * times},
              .questions = {{"ray", 12'400 * times, {{17'407, 80 * times}, {61'439, 20 * times}}}, {"box", 0, {}}},
              .undecided = 31 * times,
              .not_built = {"FCL", "octree"}});
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
TEST(TopScreen, ALineIsCutBetweenItsWords) {
  EXPECT_EQ(cli::cut_between_words("take 2 %  index 18 %  test 60 %", 29), "take 2 %  index 18 %  test…");
  EXPECT_EQ(cli::cut_between_words("whole", 5), "whole");
  EXPECT_EQ(cli::cut_between_words("äöüßx", 4), "äöü…");
}

/// The lines of the newest screen, without what clears the rest of each.
std::vector<std::string> newest_screen(const std::string& out) {
  const std::size_t begin = out.rfind("\x1b[H") + 3;
  std::string screen = out.substr(begin, out.find("\x1b[J", begin) - begin);
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < screen.size(); ++at) {
    if (screen.compare(at, 3, "\x1b[K") == 0) at += 2;
    else if (screen[at] == '\n') lines.emplace_back();
    else if (screen[at] != '\r') lines.back() += screen[at];
  }
  return lines;
}

Ran on_screen(const std::string& words, int columns, int rows) {
  return collide(
      words,
      {.out_is_terminal = true,
       .err_is_terminal = false,
       .in = {},
       .environment = {{"NO_COLOR", "1"}, {"COLUMNS", std::to_string(columns)}, {"LINES", std::to_string(rows)}}});
}

TEST_F(Top, FillsAScreenAndNoMore) {
  for (const auto& [columns, rows] : {std::pair(80, 24), std::pair(60, 24), std::pair(60, 12), std::pair(200, 50)}) {
    looks = 0;
    const Ran ran = on_screen("top -n 1 --every 10ms", columns, rows);
    const std::vector<std::string> lines = newest_screen(ran.out);
    EXPECT_EQ(lines.size(), static_cast<std::size_t>(rows)) << columns;
    for (const std::string& line : lines)
      EXPECT_LE(cli::columns_of(line), static_cast<std::size_t>(columns)) << columns << ": " << line;
    EXPECT_TRUE(lines.back().starts_with("q quit")) << lines.back();
  }
}

// At 60 columns every figure still is there whole.
TEST_F(Top, ANarrowScreenHasEveryFigure) {
  const std::vector<std::string> lines = newest_screen(on_screen("top -n 1 --every 10ms", 60, 24).out);
  const std::vector<std::string> expected{"collided 0.3 · ready · up 6 s · warehouse · world 18 204",
                                          "               RATE        P50        P99  HISTORY",
                                          "ray        12.4 k/s    17.4 us    61.4 us  ⢸",
                                          "poses         960/s          -          -  ⢸",
                                          "steps         100/s     410 us     410 us  ⢸",
                                          "60 objects, 48 moving   7 contacts hold   0 in doubt",
                                          "candidates 312 a step   undecided 0.25 %   poses lost 2",
                                          "busy 5 %   take 2 %   update 0 %   index 18 %   test 60 %",
                                          "publish 20 %",
                                          "PUBLISHER                       MESSAGES    ▾SILENT  STATE",
                                          "lift_plc                               -        4 s  silent",
                                          "walker                                 -      12 ms"};
  ASSERT_GE(lines.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(lines[i], expected[i]);
}

cli::Look look_at(std::vector<PublisherInfo> publishers) {
  cli::Look look;
  look.figures.up_ns = 2'000'000'000;
  look.status.publishers = std::move(publishers);
  return look;
}

TEST(TopScreen, PublishersAreSortedAndFiltered) {
  const auto publisher = [](const char* name, std::uint64_t sequence, std::int64_t silent_ms) {
    return PublisherInfo{
        .name = name, .applied_sequence = sequence, .silent = std::chrono::milliseconds(silent_ms), .lost = false};
  };
  cli::TopHistory history;
  history.add(look_at({publisher("a", 10, 5), publisher("b_1", 10, 50), publisher("b_2", 10, 20)}));
  const cli::Look look = look_at({publisher("a", 110, 5), publisher("b_1", 12, 50), publisher("b_2", 412, 20)});
  history.add(look);
  EXPECT_EQ(history.messages_per_second("b_2"), 201);
  const auto order = [&](const cli::TopChoice& choice) {
    std::string names;
    for (const std::string& line : cli::top_screen(look, history, choice, {}, 80, 0)) {
      for (const char* name : {"a ", "b_1 ", "b_2 "})
        if (line.starts_with(name)) names += name;
    }
    return names;
  };
  EXPECT_EQ(order({}), "b_1 b_2 a ");
  EXPECT_EQ(order({.is_reversed = true}), "a b_2 b_1 ");
  EXPECT_EQ(order({.order = cli::TopOrder::rate}), "b_2 a b_1 ");
  EXPECT_EQ(order({.order = cli::TopOrder::name}), "a b_1 b_2 ");
  EXPECT_EQ(order({.filter = "b_?"}), "b_1 b_2 ");
  EXPECT_EQ(order({.filter = "_2"}), "b_2 ");
  history.clear();
  EXPECT_EQ(history.messages_per_second("b_2"), std::nullopt);
}

// More publishers than there is room for: how many are left out is said.
TEST(TopScreen, WhatDoesNotFitIsCounted) {
  std::vector<PublisherInfo> many(40);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].name = "robot_" + std::to_string(i);
  const std::vector<std::string> lines = cli::top_screen(look_at(many), {}, {}, {}, 80, 24);
  ASSERT_EQ(lines.size(), 24U);
  std::size_t named = 0;
  for (const std::string& line : lines) named += line.starts_with("robot_") ? 1 : 0;
  EXPECT_EQ(lines[22], "and " + std::to_string(40 - named) + " more");
}

TEST(TopScreen, KeysSortFilterAndPause) {
  cli::TopChoice choice;
  const auto press = [&](std::string_view keys) {
    return std::all_of(keys.begin(), keys.end(), [&](char key) { return cli::obey(key, choice); });
  };
  EXPECT_TRUE(press("s"));
  EXPECT_EQ(choice.order, cli::TopOrder::rate);
  EXPECT_TRUE(press("ss"));
  EXPECT_EQ(choice.order, cli::TopOrder::age);
  EXPECT_TRUE(press("r "));
  EXPECT_TRUE(choice.is_reversed && choice.is_paused);
  EXPECT_TRUE(press("/q*ä\x7f")) << "while it is typed q is a letter, and a character goes whole";
  EXPECT_EQ(choice.filter, "q*");
  EXPECT_TRUE(press("\n"));
  EXPECT_FALSE(choice.is_typing);
  EXPECT_EQ(choice.filter, "q*") << "Enter keeps it";
  EXPECT_TRUE(press("/\x1b"));
  EXPECT_EQ(choice.filter, "") << "Escape drops it";
  EXPECT_FALSE(press("q"));
}

TEST(TopScreen, CurvesAreInHalvesOfCharacters) {
  EXPECT_EQ(cli::braille_curve({}, 10), "");
  EXPECT_EQ(cli::braille_curve({0, 4}, 10), "⢸");
  EXPECT_EQ(cli::braille_curve({1, 2, 3, 4}, 10), "⣠⣾");
  EXPECT_EQ(cli::braille_curve({4}, 10), "⢸") << "the newest is at the right";
  EXPECT_EQ(cli::braille_curve({9, 9, 1, 2, 3, 4}, 2), "⣠⣾") << "the older ones have no room";
  EXPECT_EQ(cli::braille_curve({0, 0.001}, 1), "⢸") << "of the largest";
  EXPECT_EQ(cli::braille_curve({0.001, 100}, 1), "⣸") << "what is not nothing is seen";
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
  const std::vector<DurationStep> durations{{10, 50}, {20, 49}, {30, 1}};
  EXPECT_EQ(view::quantile_ns(durations, 0.5), 10);
  EXPECT_EQ(view::quantile_ns(durations, 0.51), 20);
  EXPECT_EQ(view::quantile_ns(durations, 0.99), 20);
  EXPECT_EQ(view::quantile_ns(durations, 1), 30);
  EXPECT_EQ(view::quantile_ns({}, 0.5), std::nullopt);
}

}  // namespace
}  // namespace collided
