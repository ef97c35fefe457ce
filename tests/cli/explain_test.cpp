#include <gtest/gtest.h>

#include "idl/answers/explanation.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::explain_test {
namespace {

using nlohmann::json;

json meeting(const std::string& object, double distance_m) {
  return {{"object", object},        {"kind", "box"},      {"distance", distance_m},
          {"error", 1e-15},          {"point", {0, 0, 0}}, {"normal", {0, 0, 1}},
          {"triangle", 4294967295u}, {"level", "double"},  {"inside", false}};
}

json ray_answer() {
  json answer{{"answer", "hit"},
              {"reason", ""},
              {"level", "double"},
              {"nodes", 7},
              {"exact_tests", 2},
              {"objects", 5},
              {"left_out_count", 1},
              {"boxes_met", 3},
              {"met", json::array({meeting("crate", 3.8), meeting("floor", 5)})},
              {"left_out", json::array({meeting("glass", 1.2)})},
              {"misses", json::array()},
              {"stale", json::array()},
              {"unknown", json::array()},
              {"time_ns", 100},
              {"version", 9}};
  answer["left_out"][0]["why"] = "its layers 0x2 are not in the mask 0x1";
  answer["misses"].push_back({{"object", "tower"},
                              {"answer", "miss"},
                              {"distance", 0.032},
                              {"error", 1e-16},
                              {"along", 6.0},
                              {"on_ray", {0, 0, 0}},
                              {"on_object", {0, 0, 0}},
                              {"point_error", 1e-16},
                              {"triangle", 4294967295u},
                              {"box_met", true},
                              {"where", "beside"}});
  return answer;
}

json fence_answer() {
  return {
      {"name", "dock"},
      {"form", "region"},
      {"only", "forklift*"},
      {"skip", ""},
      {"mask", 4294967295u},
      {"keep", true},
      {"kind", "box"},
      {"detect", {"enter", "exit"}},
      {"placed", true},
      {"looked_at", 2},
      {"holds", json::array({{{"object", "forklift_1"},
                              {"answer", "inside"},
                              {"clearance", -0.25},
                              {"error", 1e-16},
                              {"reported", true},
                              {"since_ns", 90'000'000'000},
                              {"episode", 3},
                              {"doubt", ""}}})},
      {"others", json::array({{{"object", "forklift_2"}, {"answer", "outside"}, {"clearance", 1.5}, {"error", 0}}})},
      {"left_out", json::array({{{"object", "cart"},
                                 {"answer", "inside"},
                                 {"clearance", -1},
                                 {"error", 0},
                                 {"why", "the fence looks at 'forklift*' alone"}}})},
      {"events", json::array({{{"sequence", 3},
                               {"what", "enter"},
                               {"object", "forklift_1"},
                               {"why", ""},
                               {"doubt", ""},
                               {"low_ns", 89'999'999'000},
                               {"high_ns", 90'000'000'000}}})},
      {"time_ns", 100},
      {"version", 9}};
}

json nearest_answer() {
  const json near{{"object", "door_1"}, {"answer", "outside"},        {"clearance", 0.5}, {"error", 0},
                  {"reported", true},   {"since_ns", 90'000'000'000}, {"episode", 3},     {"doubt", ""}};
  return {{"name", "escape"},
          {"form", "nearest"},
          {"only", "door_*"},
          {"skip", "door_3"},
          {"mask", 4294967295u},
          {"keep", true},
          {"to", "guest"},
          {"within", 20},
          {"hysteresis", 0.1},
          {"placed", true},
          {"looked_at", 3},
          {"holds", json::array({near})},
          {"others", json::array({{{"object", "door_2"}, {"answer", "outside"}, {"clearance", 4}, {"error", 0}},
                                  {{"object", "door_9"}, {"answer", "outside"}, {"clearance", 30}, {"error", 0}}})},
          {"left_out", json::array({{{"object", "door_3"},
                                     {"answer", "outside"},
                                     {"clearance", 0.25},
                                     {"error", 0},
                                     {"why", "the question leaves 'door_3' out"}}})},
          {"events", json::array()},
          {"cut_short", 2},
          {"time_ns", 100},
          {"version", 9}};
}

json event_answer() {
  return {{"sequence", 881},
          {"of", "contacts"},
          {"what", "began"},
          {"why", ""},
          {"doubt", ""},
          {"a", "drone"},
          {"b", "tower"},
          {"a_triangle", 4294967295u},
          {"b_triangle", 4294967295u},
          {"depth", 0.1},
          {"error", 1e-16},
          {"point", {0, 0, 0}},
          {"normal", {0, 0, 1}},
          {"episode", 881},
          {"began_ns", 0},
          {"world_time_ns", 100'000'000'000},
          {"low_ns", 99'999'000'000},
          {"high_ns", 99'999'001'000},
          {"before", {{"time_ns", 99'999'000'000}, {"answer", "apart"}, {"clearance", 1e-7}, {"error", 1e-15}}},
          {"bodies", json::array({{{"object", "drone"},
                                   {"remembered", true},
                                   {"moving", true},
                                   {"publisher", "pilot"},
                                   {"pose", {1, 2, 3, 1, 0, 0, 0}},
                                   {"motion_from_ns", 99'900'000'000},
                                   {"motion_to_ns", 100'000'000'000}},
                                  {{"object", "tower"}, {"remembered", false}}})},
          {"why_wide", {"found on the way between two poses of 'drone', 100 ms apart, by a search that stops at 1 us"}},
          {"version", 9}};
}

class ExplainVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [this](const std::string& name, const json& arguments,
                                    const Shape&) -> Result<std::string> {
      if (name == "list") return std::string(R"({"objects":[{"name":"crate"}],"count":1,"version":5})");
      EXPECT_EQ(name, "explain");
      asked = arguments;
      if (refusal) return *refusal;
      return answer.dump();
    };
  }

  json answer;
  json asked;
  std::optional<Error> refusal;
};

TEST_F(ExplainVerb, TheNearestIsReportedWithWhatComesNextAndWhatWouldBeNearer) {
  answer = nearest_answer();
  const Ran ran = at_terminal("explain nearest escape --why-not door_4 --most 5");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked.at("standing"), "escape");
  EXPECT_EQ(asked.at("why_not"), "door_4");
  EXPECT_EQ(asked.at("most"), 5);
  for (const char* line :
       {"escape: door_1 is nearest\n", "  looks at 'door_*' but 'door_3': 3 now, within 20 m of guest\n",
        "  another one must be nearer by 0.1 m\n", "  nearest  door_1  0.5 m away  since",
        "  next     door_2  4 m away\n", "  too far  door_9  30 m away\n",
        "  left out door_3  0.25 m away; the question leaves 'door_3' out\n",
        "  cut      2 searches ended at their limit"})
    EXPECT_NE(ran.out.find(line), std::string::npos) << line << ran.out;
  EXPECT_EQ(collide("explain nearest escape --plain").out,
            "escape\tnearest\t\tguest\ttrue\t3\t1\tdoor_1\t0.5\t0\t2\t\n");
  answer["holds"] = json::array();
  answer.erase("cut_short");
  const json record = json::parse(collide("explain nearest escape --json").out);
  EXPECT_EQ(record.at("cut_short"), 0);
  EXPECT_EQ(record.value("object", json()), json());
  EXPECT_EQ(at_terminal("explain nearest escape").out.find("escape: nothing is nearest"), 0u);
  EXPECT_EQ(collide("explain nearest").code, 2);
  EXPECT_EQ(collide("explain nearest escape --recording run.mcap").code, 2);
}

// As of every verb, plain output is a short line without lists; these come with --json, --csv or by name.
TEST_F(ExplainVerb, PlainOutputHasNoLists) {
  const auto fields_of = [](const std::string& out) { return std::count(out.begin(), out.end(), '\t') + 1; };
  answer = ray_answer();
  const std::string ray = collide("explain ray 0 0 5 0 0 -1 --plain").out;
  EXPECT_EQ(ray, "hit\t\tcrate\t3.8\t1e-15\tdouble\t5\t3\t1\t\t\n");
  answer = fence_answer();
  const std::string fence = collide("explain fence dock --plain").out;
  EXPECT_EQ(fence, "dock\tregion\tbox\t\ttrue\t2\t1\t\t\t\t\t\n");
  answer = event_answer();
  const std::string event = collide("explain event 881 --plain").out;
  EXPECT_EQ(fields_of(event), 11) << event;
  for (const std::string& line : {ray, fence, event}) EXPECT_EQ(line.find_first_of("{["), std::string::npos) << line;
  EXPECT_NE(collide("explain event 881 --plain --fields bodies").out.find("[{"), std::string::npos);
}

TEST_F(ExplainVerb, ARayIsAskedAsTheRayVerbDoes) {
  answer = ray_answer();
  EXPECT_EQ(
      collide("explain ray 0 0 5 0 0 -1 --length 20 --mask 0x1 --skip 'dust*' --as-of -2s --why-not tower --most 4")
          .code,
      0);
  EXPECT_EQ(asked.at("ray"), (json{0.0, 0.0, 5.0, 0.0, 0.0, -1.0}));
  EXPECT_EQ(asked.at("length"), 20.0);
  EXPECT_EQ(asked.at("mask"), 1);
  EXPECT_EQ(asked.at("skip"), "dust*");
  EXPECT_EQ(asked.at("as_of"), "-2000000000");
  EXPECT_EQ(asked.at("why_not"), "tower");
  EXPECT_EQ(asked.at("most"), 4);
  EXPECT_EQ(collide("explain ray 0 0 5 --to 1 2 4").code, 0);
  EXPECT_EQ(asked.at("ray"), (json{0.0, 0.0, 5.0, 1.0, 2.0, -1.0}));
  EXPECT_FALSE(asked.contains("length"));
  EXPECT_FALSE(asked.contains("as_of"));
}

TEST_F(ExplainVerb, ARaysExplanationReadsAsLines) {
  answer = ray_answer();
  EXPECT_EQ(at_terminal("explain ray 0 0 5 0 0 -1").out,
            "hit  crate  3.8 m\n"
            "  decided  crate, a box, in double\n"
            "  looked   3 boxes of 5 objects on the way; 7 nodes and 2 exact tests for it\n"
            "  filter   leaves out 1 object\n"
            "  left out glass at 1.2 m: its layers 0x2 are not in the mask 0x1\n"
            "  behind   floor at 5 m\n"
            "  passed   tower by 0.032 m, 6 m along\n");
  const json record = json::parse(collide("explain ray 0 0 5 0 0 -1 --json").out);
  EXPECT_EQ(record.at("object"), "crate");
  EXPECT_EQ(record.at("misses")[0].at("distance"), 0.032);
  EXPECT_EQ(record.at("left_out")[0].at("object"), "glass");
}

TEST_F(ExplainVerb, AMissIsNoAndADoubtIsUndecided) {
  answer = ray_answer();
  answer["answer"] = "miss";
  answer["met"] = json::array();
  EXPECT_EQ(collide("explain ray 0 0 5 0 0 -1").code, 1);
  answer["answer"] = "undecided";
  answer["reason"] = "stale_object";
  answer["stale"].push_back({{"object", "lift"}, {"age_ns", 4'000'000'000}, {"from", 2.0}});
  const Ran ran = at_terminal("explain ray 0 0 5 0 0 -1");
  EXPECT_EQ(ran.code, 3);
  EXPECT_NE(ran.out.find("  stale    lift was heard of last 4 s before; it may be in the way from 2 m on\n"),
            std::string::npos)
      << ran.out;
}

TEST_F(ExplainVerb, AFencesExplanationReadsAsLines) {
  answer = fence_answer();
  EXPECT_EQ(at_terminal("explain fence dock --why-not crate").out,
            "dock: a box, 1 in it\n"
            "  looks at 'forklift*': 2 now; reports enter, exit\n"
            "  inside   forklift_1  0.25 m deep  since 90.000\n"
            "  outside  forklift_2  1.5 m away\n"
            "  left out cart  1 m deep; the fence looks at 'forklift*' alone\n"
            "  event    90.000 enter forklift_1  seq 3\n");
  EXPECT_EQ(asked.at("standing"), "dock");
  EXPECT_EQ(asked.at("why_not"), "crate");
  EXPECT_EQ(json::parse(collide("explain fence dock --json").out).at("holds")[0].at("clearance"), -0.25);
}

// The name decides what is explained, not the word before it.
TEST_F(ExplainVerb, AQuestionOfTheOtherFormIsExplainedAsWhatItIs) {
  answer = nearest_answer();
  EXPECT_EQ(at_terminal("explain fence escape").out.find("escape: door_1 is nearest\n"), 0u);
  answer = fence_answer();
  EXPECT_EQ(at_terminal("explain nearest dock").out.find("dock: a box, 1 in it\n"), 0u);
}

TEST_F(ExplainVerb, AnEventsExplanationReadsAsLines) {
  answer = event_answer();
  EXPECT_EQ(at_terminal("explain event 881").out,
            "event 881: began drone x tower\n"
            "  when     by 99.999, within 1 us\n"
            "  bracket  found on the way between two poses of 'drone', 100 ms apart, by a search that stops at 1 us\n"
            "  before   apart at 99.999, 1e-07 m\n"
            "  object   drone at 1 2 3, by publisher pilot, between poses of 99.900 and 100.000\n"
            "  object   tower: where it was then is not remembered\n");
  EXPECT_EQ(asked.at("event"), 881);
  EXPECT_FALSE(asked.contains("of"));
  EXPECT_EQ(collide("explain event 881 --of standing --json").code, 0);
  EXPECT_EQ(asked.at("of"), "standing");
}

TEST_F(ExplainVerb, WhatIsReadIsWrittenAgainAsItWas) {
  EXPECT_EQ(json_of(from_json<ExplainedRay>(ray_answer())), ray_answer());
  EXPECT_EQ(json_of(from_json<ExplainedStanding>(fence_answer())), fence_answer());
  EXPECT_EQ(json_of(from_json<ExplainedStanding>(nearest_answer())), nearest_answer());
  EXPECT_EQ(json_of(from_json<ExplainedEvent>(event_answer())), event_answer());
}

TEST_F(ExplainVerb, AnAnswerThatDoesNotFitIsNamedByThePlace) {
  const auto fault_of = [](const json& wrong) {
    try {
      from_json<ExplainedStanding>(wrong);
    } catch (const json::exception& unfit) { return std::string(unfit.what()); }
    return std::string();
  };
  json wrong = fence_answer();
  wrong["holds"][0].erase("clearance");
  EXPECT_NE(fault_of(wrong).find("holds/0/clearance is missing"), std::string::npos) << fault_of(wrong);
  wrong["holds"][0]["clearance"] = "far";
  EXPECT_NE(fault_of(wrong).find("holds/0/clearance is not a number"), std::string::npos) << fault_of(wrong);
  wrong["holds"][0]["clearance"] = "inf";
  wrong["left_out"][0]["answer"] = "somewhere";
  EXPECT_NE(fault_of(wrong).find("left_out/0/answer is a word"), std::string::npos) << fault_of(wrong);
  for (const json& mask : {json(std::uint64_t{1} << 32), json(-1)}) {
    wrong = fence_answer();
    wrong["mask"] = mask;
    EXPECT_NE(fault_of(wrong).find("mask is out of range"), std::string::npos) << fault_of(wrong);
  }
}

TEST_F(ExplainVerb, WhatIsNoQuestionIsRefusedAndNothingIsSent) {
  for (const char* wrong :
       {"", "sphere 0 0 0 1", "pair a", "pair a b c", "ray 0 0 0", "ray 0 0 0 0 0 0", "ray 0 0 0 1 0 0 --to 1 1 1",
        "ray 0 0 0 1 0 0 --length -1", "ray 0 0 0 1 0 0 --last 5s", "fence", "fence a b", "fence a --as-of -1s",
        "event", "event x", "event 0", "event 1 --of pairs", "event 1 --why-not a", "pair a b --mask 1"}) {
    const Ran ran = collide("explain " + std::string(wrong));
    EXPECT_EQ(ran.code, 2) << wrong << ran.err;
    EXPECT_TRUE(asked.is_null()) << wrong;
  }
}

TEST_F(ExplainVerb, AnObjectThatIsNotThereIsNamed) {
  refusal = Error{ErrorCode::refused, "server refused: no object", ""};
  EXPECT_EQ(collide("explain ray 0 0 5 0 0 -1 --why-not crte").err,
            "error: object 'crte' is not in the world (1 object); nearest names: crate\n");
  // It may have been there at another instant.
  EXPECT_EQ(collide("explain ray 0 0 5 0 0 -1 --why-not crte --as-of -2s").err, "error: server refused: no object\n");
}

}  // namespace
}  // namespace collided::explain_test
