// Every field of every record is compared, each with a number that no other field has.
#include <gtest/gtest.h>

#include "idl/answers/figures.hpp"
#include "idl/described_json.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

class Fields : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static std::vector<json> records(const std::string& words) {
    const Ran ran = collide(words + " --json");
    EXPECT_EQ(ran.err, "") << words;
    std::vector<json> all;
    std::istringstream lines(ran.out);
    for (std::string line; std::getline(lines, line);) all.push_back(json::parse(line));
    return all;
  }
  static Hit hit(double from) {
    Hit hit;
    hit.object = "hit " + std::to_string(static_cast<int>(from));
    hit.triangle = static_cast<std::uint32_t>(from);
    hit.distance_m = from + 1;
    hit.error_m = 0.25 / from;
    hit.exit_m = from + 2;
    hit.point = {from + 3, from + 4, from + 5};
    hit.point_error_m = 0.125 / from;
    hit.normal = {from + 6, from + 7, from + 8};
    hit.weights = {from + 9, from + 10, from + 11};
    hit.time_low = from + 12;
    hit.time_high = from + 13;
    hit.inside = true;
    hit.stale = true;
    return hit;
  }
};

TEST_F(Fields, OfARayAreItsHits) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    Hit second = hit(64);
    second.inside = second.stale = false;
    return fake::hit_answer({hit(32), second});
  };
  const std::vector<json> all = records("ray 0 0 5 0 0 -1 --all");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(
      all[0],
      json::parse(
          R"({"answer":"hit","object":"hit 32","distance":33,"error":0.0078125,"point":[35,36,37],"normal":[38,39,40],
                                    "triangle":32,"order":0,"exit":34,"inside":true,"stale":true,"point_error":0.00390625})"));
  EXPECT_EQ(
      all[1],
      json::parse(
          R"({"answer":"hit","object":"hit 64","distance":65,"error":0.00390625,"point":[67,68,69],"normal":[70,71,72],
                                    "triangle":64,"order":1,"point_error":0.001953125})"));
}

TEST_F(Fields, OfTheOtherQuestionsAreTheirHits) {
  fake::server().near = [](const NearQuestion&, const AskOptions&) { return fake::hit_answer({hit(32)}); };
  fake::server().sphere = [](const SphereQuestion&, const AskOptions&) { return fake::hit_answer({hit(32)}); };
  fake::server().box = [](const BoxQuestion&, const AskOptions&) { return fake::hit_answer({hit(32)}); };
  fake::server().sweep = [](const Shape&, const SweepQuestion&, const AskOptions&) {
    return fake::hit_answer({hit(32)});
  };
  EXPECT_EQ(records("near 0 0 5").at(0),
            json::parse(R"({"answer":"hit","object":"hit 32","distance":33,"error":0.0078125,"point":[35,36,37],
                                                      "normal":[38,39,40],"triangle":32,"inside":true,"stale":true,"point_error":0.00390625})"));
  const json contact = json::parse(
      R"({"answer":"hit","object":"hit 32","depth":33,"error":0.0078125,"point":[35,36,37],"normal":[38,39,40],
                                       "triangle":32,"inside":true,"stale":true})");
  EXPECT_EQ(records("sphere 0 0 5 1").at(0), contact);
  EXPECT_EQ(records("box 0 0 0 1 1 1").at(0), contact);
  EXPECT_EQ(
      records("sweep sphere 1 --from 0 0 0 --to 1 1 1").at(0),
      json::parse(
          R"({"answer":"contact","object":"hit 32","time_low":44,"time_high":45,"point":[35,36,37],"normal":[38,39,40],"triangle":32,"inside":true,"stale":true})"));
}

TEST_F(Fields, OfAPairAreThoseOfItsAnswer) {
  PairAnswer pair;
  pair.version = 9;
  pair.normal = {1, 2, 3};
  pair.distance_m = 4;
  pair.depth_m = 5;
  pair.error_m = 6;
  pair.on_a = {7, 8, 9};
  pair.on_b = {10, 11, 12};
  pair.point = {13, 14, 15};
  pair.a_triangle = 16;
  pair.b_triangle = 17;
  pair.manifold = {{.point = {18, 19, 20}, .depth_m = 21, .error_m = 22}};
  fake::server().pair = [&](const std::string& a, const std::string& b, const PairOptions&) {
    EXPECT_EQ(a + b, "xy") << "in the order that they were asked in";
    return pair;
  };
  pair.contained = Containment::a_in_b;
  EXPECT_EQ(
      records("pair x y").at(0),
      json::parse(
          R"({"answer":"apart","distance":4,"error":6,"normal":[1,2,3],"on_a":[7,8,9],"on_b":[10,11,12],"contained":"a","world":9})"));
  pair.contained = Containment::b_in_a;
  EXPECT_EQ(records("pair x y").at(0)["contained"], "b");
  pair.contained = Containment::none;
  EXPECT_EQ(records("pair x y").at(0)["contained"], "");
  pair.verdict = Verdict::hit;
  EXPECT_EQ(
      records("pair x y").at(0),
      json::parse(
          R"({"answer":"touching","depth":5,"error":6,"normal":[1,2,3],"point":[13,14,15],"a_triangle":16,"b_triangle":17,
                                                     "manifold":[{"point":[18,19,20],"depth":21,"error":22}],"world":9})"));
  pair.triangle_pairs = {{.a_triangle = 23, .b_triangle = 24, .from = {25, 26, 27}, .to = {28, 29, 30}, .error_m = 31}};
  EXPECT_EQ(records("pair x y --triangles").at(0),
            json::parse(R"({"a_triangle":23,"b_triangle":24,"from":[25,26,27],"to":[28,29,30],"error":31})"));
  const Ran ran = at_terminal("pair x y");
  EXPECT_EQ(ran.out, "touching  depth 5 m ±6  at 13 14 15  apart by 5 10 15\n  bears at 18 19 20  21 m ±22 deep\n");
}

Event event(EventKind what) {
  Event event;
  event.kind = what;
  event.reason = what == EventKind::ended ? EndReason::teleported : EndReason::none;
  event.resync = true;
  event.a = "x";
  event.b = "y";
  event.a_id = 1;
  event.b_id = 2;
  event.a_triangle = 3;
  event.b_triangle = 4;
  event.epoch = 5;
  event.sequence = 6;
  event.episode = 7;
  event.world_time = std::chrono::milliseconds(8'500);
  event.began = std::chrono::milliseconds(8'250);
  event.bracket_low_s = -9;
  event.bracket_high_s = -10;
  event.point = {11, 12, 13};
  event.normal = {14, 15, 16};
  event.depth_m = 17;
  event.depth_error_m = 18;
  event.surface_normal = event.normal;
  event.relative_velocity = {19, 20, 21};
  event.velocity_error = 22;
  return event;
}

TEST_F(Fields, OfAnEventAreTheServersOwn) {
  fake::server().events = {event(EventKind::open), event(EventKind::began), event(EventKind::persisted),
                           event(EventKind::ended)};
  Event& at_inner_edge = fake::server().events[2];
  at_inner_edge.surface_normal = {0, 0, 1};
  at_inner_edge.surface_depth_m = 0.5;
  std::vector<json> all;
  const Ran ran = collide("watch -n 4 --persisted --json");
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) all.push_back(json::parse(line));
  ASSERT_EQ(all.size(), 4U);
  const json open = json::parse(
      R"({"time":8.5,"time_ns":8500000000,"what":"open","a":"x","b":"y","depth":17,"error":18,"point":[11,12,13],"normal":[14,15,16],"a_triangle":3,"b_triangle":4,
                                    "resync":true,"sequence":6,"episode":7,"bracket_low":-9,"bracket_high":-10,"epoch":5})");
  EXPECT_EQ(all[0], open);
  json began = open;
  began["what"] = "began";
  began["velocity"] = {19, 20, 21};
  began["velocity_error"] = 22;
  json persisted = began;
  persisted["what"] = "persisted";
  persisted["surface_normal"] = {0, 0, 1};
  persisted["surface_depth"] = 0.5;
  EXPECT_EQ(all[2], persisted);
  // Only what begins or ends does so between two instants.
  began["first_ns"] = 17'500'000'000;
  began["last_ns"] = 18'500'000'000;
  EXPECT_EQ(all[1], began);
  EXPECT_EQ(
      all[3],
      json::parse(
          R"({"time":8.5,"time_ns":8500000000,"first_ns":17500000000,"last_ns":18500000000,"what":"ended","a":"x","b":"y","after":10.25,"why":"teleported","a_triangle":3,"b_triangle":4,"resync":true,
                                    "sequence":6,"episode":7,"bracket_low":-9,"bracket_high":-10,"epoch":5})"));
}

TEST_F(Fields, OfWhatLiesWithinASolidNameItByItsPlaceInTheSortedPair) {
  Event contained = event(EventKind::contained);
  contained.contained = Containment::b_in_a;
  Event emerged = event(EventKind::emerged);
  emerged.contained = Containment::b_in_a;
  std::swap(emerged.a, emerged.b);
  fake::server().events = {contained, emerged};
  const Ran ran = collide("watch -n 2 --json");
  std::istringstream lines(ran.out);
  std::string first, second;
  std::getline(lines, first);
  std::getline(lines, second);
  const json in = json::parse(first);
  EXPECT_EQ(in["what"], "contained");
  EXPECT_EQ(in["contained"], "b");
  EXPECT_EQ(in["depth"], 17);
  EXPECT_EQ(in["first_ns"], 17'500'000'000);
  const json out = json::parse(second);
  EXPECT_EQ(out["what"], "emerged");
  EXPECT_EQ(out["contained"], "a");
  EXPECT_FALSE(out.contains("depth"));
}

// Neither a depth nor a place is made up where it is not known whether the two touch.
TEST_F(Fields, ADoubtIsToldWithItsReasonAndNothingThatNobodyKnows) {
  Event began = event(EventKind::began);
  began.doubt = Doubt::cost_limit;
  Event ended = event(EventKind::ended);
  ended.reason = EndReason::decided;
  ended.doubt = Doubt::numeric;
  fake::server().events = {began, ended};
  const Ran ran = collide("watch -n 2 --json");
  std::istringstream lines(ran.out);
  std::string first, second;
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_EQ(
      json::parse(first),
      json::parse(
          R"({"time":8.5,"time_ns":8500000000,"first_ns":17500000000,"last_ns":18500000000,"what":"began","a":"x","b":"y","doubt":"cost_limit","a_triangle":3,
                                               "b_triangle":4,"resync":true,"sequence":6,"episode":7,"bracket_low":-9,"bracket_high":-10,"epoch":5})"));
  EXPECT_EQ(json::parse(second)["doubt"], "numeric");
  EXPECT_EQ(json::parse(second)["why"], "decided");
  EXPECT_EQ(json::parse(second)["after"], 10.25);
  fake::server().events = {began};
  const std::string text = at_terminal("watch -n 1").out;
  EXPECT_NE(text.find("began  x x y  in doubt (cost_limit)  seq 6"), std::string::npos) << text;
  EXPECT_EQ(text.find("depth"), std::string::npos) << text;
}

TEST_F(Fields, PairsInDoubtAreCountedInTheStatus) {
  fake::server().command = [](const std::string& name, const json&, const Shape&) -> Result<std::string> {
    return name == "figures" ? json_of(Figures{.pairs = {.in_doubt = 3}}).dump() : std::string("{}");
  };
  EXPECT_EQ(collide("status --fields in_doubt").out, "3\n");
  EXPECT_NE(at_terminal("status").out.find("\n3 pairs in doubt"), std::string::npos) << at_terminal("status").out;
}

TEST_F(Fields, WhatIsHeldOfASceneInTilesIsInTheStatus) {
  Figures figures;
  fake::server().command = [&](const std::string& name, const json&, const Shape&) -> Result<std::string> {
    return name == "figures" ? json_of(figures).dump() : std::string("{}");
  };
  EXPECT_EQ(collide("status --fields tiles").out, "[]\n");
  EXPECT_EQ(at_terminal("status").out.find("tiles"), std::string::npos);
  figures.tiles.push_back({.scene = "hills", .read = 12, .of = 64, .triangles = 310, .triangles_of_file = 999});
  EXPECT_NE(at_terminal("status").out.find("\ntiles of hills  12 of 64 read  ·  310 of 999 triangles held\n"),
            std::string::npos)
      << at_terminal("status").out;
  EXPECT_EQ(json::parse(collide("status --fields tiles").out), json_of(figures.tiles));
}

TEST_F(Fields, SearchesThatWereCutShortAreCountedInTheStatus) {
  std::uint64_t count = 0;
  fake::server().command = [&](const std::string& name, const json&, const Shape&) -> Result<std::string> {
    return name == "figures" ? json_of(Figures{.fences = {.cut_short = count}}).dump() : std::string("{}");
  };
  EXPECT_EQ(collide("status --fields cut_short").out, "0\n");
  EXPECT_EQ(at_terminal("status").out.find("limit"), std::string::npos);
  for (const auto& [searches, words] :
       {std::pair(1, "\n1 search of fences ended at the limit"), std::pair(3, "\n3 searches of fences")}) {
    count = static_cast<std::uint64_t>(searches);
    EXPECT_EQ(collide("status --fields cut_short").out, std::to_string(searches) + "\n");
    EXPECT_NE(at_terminal("status").out.find(words), std::string::npos) << at_terminal("status").out;
  }
}

TEST_F(Fields, EveryReasonOfAnEndHasItsOwnWord) {
  const std::vector<std::pair<EndReason, const char*>> words{{EndReason::separated, "separated"},
                                                             {EndReason::removed, "removed"},
                                                             {EndReason::publisher_lost, "publisher_lost"},
                                                             {EndReason::teleported, "teleported"},
                                                             {EndReason::geometry_changed, "geometry_changed"},
                                                             {EndReason::server_stopping, "server_stopping"},
                                                             {EndReason::server_restarted, "server_restarted"},
                                                             {EndReason::decided, "decided"},
                                                             {EndReason::allowed, "allowed"}};
  for (const auto& [why, word] : words) {
    Event ended = event(EventKind::ended);
    ended.reason = why;
    fake::server().events = {ended};
    EXPECT_EQ(collide("watch -n 1 --fields why").out, word + std::string("\n"));
  }
}

TEST_F(Fields, EveryReasonOfAnUndecidedAnswerHasItsOwnWord) {
  const std::vector<std::pair<UndecidedReason, std::string>> words{
      {UndecidedReason::numeric, "numeric"},       {UndecidedReason::stale_object, "stale_object"},
      {UndecidedReason::recovering, "recovering"}, {UndecidedReason::truncated, "truncated"},
      {UndecidedReason::deadline, "deadline"},     {UndecidedReason::not_covered, "not_covered"}};
  for (const auto& [reason, word] : words) {
    fake::server().ray = [reason = reason](const RayQuestion&, const AskOptions&) {
      Answer answer;
      answer.verdict = Verdict::undecided;
      answer.reason = reason;
      return answer;
    };
    EXPECT_EQ(collide("ray 0 0 5 0 0 -1 --fields reason").out, word + "\n");
    EXPECT_NE(at_terminal("ray 0 0 5 0 0 -1").out.find("undecided: " + word + "; "), std::string::npos) << word;
  }
}

TEST_F(Fields, OfAReadingAreTheProbesOwn) {
  fake::server().readings = {{.probe = "p",
                              .object = "o",
                              .state = Clearance::deeper,
                              .clearance_m = -1,
                              .error_m = 2,
                              .met = "m",
                              .triangle = 3,
                              .point = {4, 5, 6},
                              .normal = {7, 8, 9},
                              .epoch = 10,
                              .version = 11,
                              .world_time = std::chrono::milliseconds(12'500)}};
  const json expected = json::parse(
      R"({"time":12.5,"probe":"p","state":"deeper","clearance":-1,"error":2,"met":"m","point":[4,5,6],"normal":[7,8,9],"triangle":3,"object":"o","world":11})");
  EXPECT_EQ(records("probe").at(0), expected);
  EXPECT_EQ(json::parse(collide("probe --watch -n 1 --json").out), expected);
}

TEST_F(Fields, OfAStatusAreTheServersOwn) {
  ServerStatus status;
  status.name_space = "ns";
  status.version_text = "v";
  status.pid = 1;
  status.state = "ready";
  status.epoch = 2;
  status.version = 3;
  status.world_time = std::chrono::milliseconds(4'500);
  status.last_event_sequence = 5;
  status.contacts = 6;
  status.contacts_truncated = true;
  status.scenes = {"s", "t"};
  status.static_triangles = 7;
  status.objects = 8;
  status.moving = 9;
  status.poses_applied = 10;
  status.poses_dropped = 11;
  status.questions_answered = 12;
  status.questions_refused = 13;
  status.undecided_answers = 14;
  status.step_lasting = std::chrono::milliseconds(1'500);
  status.age = std::chrono::milliseconds(15'500);
  status.publishers = {{"p", 16, std::chrono::milliseconds(17'500), true},
                       {"q", 18, std::chrono::milliseconds(19'500), false}};
  fake::server().status = status;
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return std::string("{}");
  };
  EXPECT_EQ(
      records("--domain 20 status").at(0),
      json::parse(
          R"({"state":"ready","version_text":"v","pid":1,"domain":20,"namespace":"ns","epoch":2,"world":3,"world_time":4.5,"scenes":["s","t"],
                            "static_triangles":7,"objects":8,"moving":9,"contacts":6,"contacts_truncated":true,"keeps_nothing":false,"poses_applied":10,"poses_dropped":11,
                            "questions_answered":12,"questions_refused":13,"undecided_answers":14,"last_event_sequence":5,"step_lasting":1.5,"age":15.5,
                            "publishers":[{"name":"p","applied_sequence":16,"silent":17.5,"lost":true},{"name":"q","applied_sequence":18,"silent":19.5,"lost":false}]})"));
  const std::string text = at_terminal("--domain 20 status").out;
  EXPECT_EQ(text.substr(0, text.find("contacts are missing")),
            "collided v pid 1  domain 20  namespace ns  ready, step has lasted 1.5 s\n"
            "scene s, t  7 triangles  ·  8 objects, 9 moving  ·  6 open contacts  ·  world 3\n"
            "poses 10 applied, 11 dropped  ·  questions 12 answered, 13 refused, 14 undecided\n");
}

// What an undecided answer shows is known then: shown once, and not again while nothing moves.
TEST_F(Fields, AMoveWithinUndecidedAnswersIsToldOnce) {
  int asked = 0;
  fake::server().near = [&](const NearQuestion&, const AskOptions&) {
    ++fake::server().version;
    ++asked;
    Answer answer = fake::hit_answer({fake::hit("crate", asked == 1 ? 1 : 2, {0, 0, 0})});
    if (asked > 1 && asked < 5) answer.verdict = Verdict::undecided;
    if (asked >= 6) answer.hits.clear();
    return answer;
  };
  const Ran ran = collide("near 0 0 0 --watch --every 1ms -n 5 --fields change,object,distance");
  EXPECT_EQ(ran.out, "enter\tcrate\t1\nundecided\t\t\nmoved\tcrate\t2\ndecided\t\t\nexit\tcrate\t\n");
}

// A server that began anew counts its versions from the start: the same number is another world.
TEST_F(Fields, TheSameVersionOfAnotherLifeIsAnotherWorld) {
  int asked = 0;
  fake::server().near = [&](const NearQuestion&, const AskOptions&) {
    if (++asked == 3) ++fake::server().epoch;
    return fake::hit_answer({fake::hit(asked < 3 ? "crate" : "shelf", 1, {0, 0, 0})});
  };
  const Ran ran = collide("near 0 0 0 --watch --every 1ms -n 3 --for 5s --fields change,object");
  EXPECT_EQ(ran.out, "enter\tcrate\nenter\tshelf\nexit\tcrate\n");
}

}  // namespace
}  // namespace collided
