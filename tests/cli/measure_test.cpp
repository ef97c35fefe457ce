#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class Measure : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [this](const std::string& name, const nlohmann::json& arguments,
                                    const Shape&) -> Result<std::string> {
      asked = arguments;
      return replies.at(name).dump();
    };
  }

  std::map<std::string, nlohmann::json> replies;
  nlohmann::json asked;
};

nlohmann::json menu_row(const char* method, nlohmann::json bound) {
  return {{"kind", "ray"}, {"method", method},       {"asked", 300},         {"judged", 300},  {"undecided", 0},
          {"wrong", 7},    {"worst_error", 4.4e-16}, {"worst_bound", bound}, {"p50_ns", 2100}, {"p99_ns", 7700}};
}

Ran with(const std::string& words, const std::string& in) { return collide(words, {.in = in}); }

TEST_F(Measure, TheMenuIsAPriceList) {
  replies["menu"] = {
      {"rows", {menu_row("exact on doubt", 2e-15), menu_row("boxes only", "inf")}}, {"seed", 7}, {"version", 9}};
  EXPECT_EQ(at_terminal("menu --questions 300 --seed 7").out,
            "ASKED  METHOD          WORST ERROR  BOUND    P50     P99     UNDECIDED  WRONG\n"
            "ray    exact on doubt  4.4e-16 m    2e-15 m  2.1 us  7.7 us  0          7\n"
            "ray    boxes only      4.4e-16 m    none     2.1 us  7.7 us  0          7\n");
  EXPECT_EQ(asked["questions"], 300);
  EXPECT_EQ(asked["seed"], 7);
  EXPECT_EQ(collide("menu --json --fields kind,method,worst_bound").out,
            "{\"kind\":\"ray\",\"method\":\"exact on doubt\",\"worst_bound\":2e-15}\n"
            "{\"kind\":\"ray\",\"method\":\"boxes only\",\"worst_bound\":\"inf\"}\n");
}

TEST_F(Measure, AMenuMayHaveADeadlineAndSaysWhereItEndedThere) {
  replies["menu"] = {{"rows", {menu_row("exact on doubt", 2e-15)}}, {"seed", 7}, {"version", 9}, {"late", true}};
  const Ran ran = at_terminal("menu --deadline 1.5s");
  EXPECT_EQ(asked["deadline_ns"], 1'500'000'000);
  EXPECT_NE(ran.err.find("the deadline was over before all questions were asked"), std::string::npos) << ran.err;
  replies["menu"].erase("late");
  EXPECT_EQ(at_terminal("menu").err.find("deadline"), std::string::npos);
  EXPECT_FALSE(asked.contains("deadline_ns"));
}

TEST_F(Measure, WhatWasOnlyTimedIsNotCalledRight) {
  nlohmann::json row = menu_row("exact on doubt", 2e-15);
  row["judged"] = 40;
  replies["menu"] = {{"rows", {row}}, {"seed", 7}, {"version", 9}};
  const Ran ran = at_terminal("menu");
  EXPECT_NE(ran.out.find("  7 of 40\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.err.find("were only timed"), std::string::npos) << ran.err;
  EXPECT_EQ(collide("menu --json --fields asked,judged,wrong").out, "{\"asked\":300,\"judged\":40,\"wrong\":7}\n");
}

// Numbers as the server wants them, whatever form the file has.
TEST_F(Measure, TheMenuTakesYourOwnQuestions) {
  replies["menu"] = {{"rows", {menu_row("exact on doubt", 2e-15)}}, {"seed", 1}, {"version", 9}};
  const auto sent = [] {
    std::vector<double> numbers(fake::server().bytes.size() / sizeof(double));
    std::memcpy(numbers.data(), fake::server().bytes.data(), fake::server().bytes.size());
    return numbers;
  };
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  EXPECT_EQ(with("menu --from - --of ray", "fx fy fz tx ty tz\n0 0 5 0 0 4\n1 2 3 1 2 4\n").code, 0);
  EXPECT_EQ(asked, (nlohmann::json{{"of", "ray"}}));
  EXPECT_EQ(sent(), (std::vector<double>{0, 0, 5, 0, 0, -1, kEndless, 1, 2, 3, 0, 0, 1, kEndless}));
  with("menu --from - --of box", R"({"low":[0,0,0],"high":[2,4,6]})"
                                 "\n");
  EXPECT_EQ(sent(), (std::vector<double>{1, 2, 3, 1, 2, 3, 1, 0, 0, 0}));
  with("menu --from - --of sphere", "1,2,3,0.5\n");
  EXPECT_EQ(sent(), (std::vector<double>{1, 2, 3, 0.5}));
  with("menu --from - --of near", "1 2 3 4\n");
  EXPECT_EQ(sent(), (std::vector<double>{1, 2, 3, 4}));
}

TEST_F(Measure, QuestionsThatAreNoneAreNotAsked) {
  replies["menu"] = {{"rows", nlohmann::json::array()}};
  Ran ran = with("menu --from - --of ray", "0 0 5 0 0 1\n0 0 5 0 0 NaN\n");
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("stdin line 2: 'NaN' in column dz; nothing was asked"), std::string::npos) << ran.err;
  EXPECT_NE(with("menu --from - --of ray", "").err.find("stdin holds no question"), std::string::npos);
  EXPECT_NE(with("menu --from -", "").err.find("--of ray, sphere, box or near"), std::string::npos);
  EXPECT_NE(collide("menu --of pair").err.find("--from FILE"), std::string::npos);
  std::string many;
  for (int i = 0; i < 10'001; ++i) many += "1 2 3 4\n";
  EXPECT_NE(with("menu --from - --of near", many).err.find("more than 10 000 questions"), std::string::npos);
  EXPECT_TRUE(asked.is_null());
}

TEST_F(Measure, TheMenuHasAColumnForFcl) {
  nlohmann::json row = menu_row("exact on doubt", 2e-15);
  row["opinion"] = {{"agree", 298}, {"differ", 1}, {"failed", 0}, {"unsupported", 1}};
  replies["menu"] = {{"rows", {row, menu_row("boxes only", "inf")}}, {"seed", 7}, {"version", 9}};
  const std::string table = at_terminal("menu --opinion fcl").out;
  EXPECT_EQ(asked["opinion"], "fcl");
  EXPECT_NE(table.find("WRONG  FCL\n"), std::string::npos) << table;
  EXPECT_NE(table.find("7      298 agree, 1 differ, 1 unsupported\n"), std::string::npos) << table;
  EXPECT_EQ(collide("menu --opinion fcl --json --fields agree,differ,failed,unsupported").out,
            "{\"agree\":298,\"differ\":1,\"failed\":0,\"unsupported\":1}\n{\"agree\":0,\"differ\":0,\"failed\":0,"
            "\"unsupported\":0}\n");
  EXPECT_EQ(at_terminal("menu").out.find("FCL"), std::string::npos);
  EXPECT_FALSE(asked.contains("opinion"));
}

TEST_F(Measure, AnEmptyWorldHasNoMenu) {
  replies["menu"] = {{"rows", nlohmann::json::array()}, {"seed", 1}, {"version", 9}};
  const Ran ran = collide("menu");
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("the world is empty"), std::string::npos);
}

nlohmann::json audit(int every, int differing) {
  nlohmann::json differences = nlohmann::json::array();
  if (differing > 0) differences.push_back("ray 0 0 5: the first hit is at 4");
  return {{"every", every},
          {"chosen", 12419},
          {"audited", 12419},
          {"differing", differing},
          {"skipped", 0},
          {"float_repairs", 0},
          {"differences", differences},
          {"questions", {{{"kind", "ray"}, {"double", 12417}, {"expansion", 2}, {"rational", 0}}}}};
}

TEST_F(Measure, AnAuditWithoutDifferenceIsAYes) {
  replies["audit"] = audit(1000, 0);
  const Ran ran = at_terminal("audit");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "since start 12 419 re-asked, 0 differ\n"
            "ASKED  DOUBLE  EXPANSION  RATIONAL\n"
            "ray    12 417  2          0\n");
}

TEST_F(Measure, AnAuditTellsFclsOpinion) {
  replies["audit"] = audit(1000, 0);
  replies["audit"]["opinion"] = {{"agree", 1200}, {"differ", 2}, {"failed", 0}, {"unsupported", 30}};
  EXPECT_NE(at_terminal("audit").out.find("FCL: 1 200 agree, 2 differ, 30 unsupported\n"), std::string::npos);
  EXPECT_EQ(collide("audit --json --fields agree,differ,failed,unsupported").out,
            "{\"agree\":1200,\"differ\":2,\"failed\":0,\"unsupported\":30}\n");
}

TEST_F(Measure, ADifferenceIsShownAndANo) {
  replies["audit"] = audit(1000, 1);
  const Ran ran = at_terminal("audit");
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.out.find("1 differ\n  ray 0 0 5: the first hit is at 4\n"), std::string::npos);
}

TEST_F(Measure, AServerWithoutAuditorSaysHowToGetOne) {
  replies["audit"] = audit(0, 0);
  EXPECT_NE(collide("audit").err.find("--audit 1/1000"), std::string::npos);
}

}  // namespace
}  // namespace collided
