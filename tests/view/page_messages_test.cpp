#include "client/view/page_answers.hpp"
#include "client/view/page_messages.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include <nlohmann/json.hpp>

#include "client/view/page_question.hpp"

namespace collided::view {
namespace {

using nlohmann::json;

template <class T>
T at(const std::string& bytes, std::size_t place) {
  T value;
  EXPECT_LE(place + sizeof(T), bytes.size());
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  return value;
}

// Four thousand kilometres out a float has steps of half a metre: a millimetre stays one, since positions are relative.
TEST(PageMessages, ASurfaceFarOutKeepsItsDigits) {
  const Vec3 far_m{4'649'000, 500'000, 12};
  Surface surface;
  surface.vertices = {far_m, far_m + Vec3{0.001, 0, 0}, far_m + Vec3{0, 2, 0}};
  surface.triangles = {{0, 1, 2}};
  const std::string bytes = surface_bytes(surface);
  ASSERT_EQ(bytes.size(), 32U + 3 * 12 + 12);
  EXPECT_EQ(at<std::uint32_t>(bytes, 0), 3U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 1U);
  for (std::size_t vertex = 0; vertex < 3; ++vertex) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double told = at<double>(bytes, 8 + 8 * axis) + at<float>(bytes, 32 + 12 * vertex + 4 * axis);
      EXPECT_NEAR(told, surface.vertices[vertex][static_cast<Eigen::Index>(axis)], 1e-6);
    }
  }
  EXPECT_EQ(at<std::uint32_t>(bytes, 32 + 36 + 8), 2U);
}

// As the server lists them, with the distance of what is nearest.
TEST(PageMessages, StandingQuestionsComeWithTheirLinesAndWhatTheyHold) {
  std::vector<draw::StandingOutline> outlines(3);
  outlines[0].name = "dock";
  outlines[0].only = "cart*";
  outlines[0].holds = {{.object = "ball"}, {.object = "cart", .in_doubt = true}};
  outlines[0].lines = {{0, 1, 2, 3, 4, 5}};
  outlines[1].name = "close";
  outlines[1].form = StandingForm::bands;
  outlines[1].about = "person";
  outlines[1].band_m = 0.5;
  outlines[2].name = "escape";
  outlines[2].form = StandingForm::nearest;
  outlines[2].to = "guest";
  outlines[2].distance_m = 1.5;
  const json text = json::parse(standing_text(outlines));
  EXPECT_EQ(text.at("type"), "standing");
  const json& dock = text.at("standing")[0];
  EXPECT_EQ(dock.at("form"), "region");
  EXPECT_EQ(dock.at("only"), "cart*");
  EXPECT_EQ(dock.at("lines"), (json{{0.0, 1.0, 2.0, 3.0, 4.0, 5.0}}));
  EXPECT_EQ(dock.at("holds")[0], json::parse(R"({"object":"ball","in_doubt":false,"since_ns":0})"));
  EXPECT_EQ(dock.at("holds")[1].at("in_doubt"), true);
  EXPECT_FALSE(dock.contains("band"));
  const json& close = text.at("standing")[1];
  EXPECT_EQ(close.at("form"), "bands");
  EXPECT_EQ(close.at("about"), "person");
  EXPECT_EQ(close.at("band"), 0.5);
  EXPECT_EQ(close.at("holds"), json::array());
  EXPECT_FALSE(close.contains("distance"));
  const json& escape = text.at("standing")[2];
  EXPECT_EQ(escape.at("form"), "nearest");
  EXPECT_EQ(escape.at("to"), "guest");
  EXPECT_EQ(escape.at("distance"), 1.5);
}

TEST(PageMessages, PosesLieAsThePageReadsThem) {
  Poses poses;
  poses.version = 42;
  poses.table_version = 7;
  poses.world_time = std::chrono::milliseconds(1'500);
  poses.ids = {3, (std::uint64_t{5} << 32) + 9};
  poses.poses = {{{1e6, 0, 0}, Quat::Identity()}, {{1e6 + 2, 0.25, 0}, Quat(0, 1, 0, 0)}};
  poses.stale = {0, 1};
  const std::string bytes = poses_bytes(poses);
  ASSERT_EQ(bytes.size(), 56U + 2 * 33);
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(at<double>(bytes, 8), 1.5);
  EXPECT_EQ(at<double>(bytes, 16), 7);
  EXPECT_EQ(at<double>(bytes, 24), 42);
  EXPECT_EQ(at<double>(bytes, 32) + at<float>(bytes, 56 + 28), 1e6 + 2);
  EXPECT_EQ(at<float>(bytes, 56 + 28 + 4), 0.25F);
  EXPECT_EQ(at<float>(bytes, 56 + 28 + 16), 1.F) << "w x y z";
  EXPECT_EQ(at<std::uint32_t>(bytes, 56 + 56 + 4), 9U) << "slots, without generations";
  EXPECT_EQ(bytes.back(), 1);
}

TEST(PageMessages, EveryKindOfShapeIsTold) {
  ShownObject object;
  object.id = 4;
  object.name = "all \"kinds\"\xff";
  object.parts = {SphereShape{.radius_m = 0.1},
                  BoxShape{.half_m = {1, 2, 3}},
                  CapsuleShape{.a = {0, 0, 0}, .b = {0, 0, 1}, .radius_m = 0.2},
                  CylinderShape{.radius_m = 0.3},
                  ConeShape{.radius_m = 0.4},
                  EllipsoidShape{.half_m = {1, 2, 3}},
                  HalfSpaceShape{}};
  const auto surface = std::make_shared<Surface>();
  surface->number = 0xffffffffffffffff;
  object.runs = {{.surface = surface, .first_triangle = 1, .triangle_count = 2}};
  const json told = json::parse(objects_text({.epoch = 1, .version = 2, .table_version = 3, .objects = {object}}));
  const json& one = told["objects"][0];
  std::vector<std::size_t> numbers;
  for (const json& part : one["parts"]) numbers.push_back(part.size());
  EXPECT_EQ(numbers, (std::vector<std::size_t>{5, 11, 8, 8, 8, 11, 7}));
  EXPECT_EQ(one["runs"][0], json({"18446744073709551615", 1, 2}));
  EXPECT_EQ(one["slot"], 4);
}

Event event(const std::string& a, EventKind what) {
  Event one;
  one.kind = what;
  one.a = a;
  one.b = "floor";
  one.depth_m = 0.25;
  one.reason = what == EventKind::ended ? EndReason::separated : EndReason::none;
  return one;
}

TEST(PageMessages, OfTooManyEventsTheNewestAreTold) {
  const std::vector<Event> events{event("a", EventKind::began), event("b", EventKind::began),
                                  event("c", EventKind::ended)};
  const json told = json::parse(events_text(events, 2));
  EXPECT_EQ(told["left_out"], 1);
  EXPECT_EQ(told["events"][0]["a"], "b");
  EXPECT_EQ(told["events"][1]["why"], "separated");
  EXPECT_FALSE(told["events"][1].contains("depth"));
}

// Every figure is by itself, so that none can stand for another.
TEST(PageMessages, AStatusHasEveryFigure) {
  ServerStatus status;
  status.name_space = "hall";
  status.version_text = "1.2.3";
  status.pid = 4;
  status.state = "ready";
  status.epoch = 5;
  status.version = 6;
  status.world_time = std::chrono::milliseconds(1'500);
  status.contacts = 8;
  status.contacts_truncated = true;
  status.scenes = {"a", "b"};
  status.static_triangles = 9;
  status.objects = 10;
  status.moving = 11;
  status.questions_answered = 12;
  status.undecided_answers = 13;
  status.step_lasting = std::chrono::milliseconds(2'500);
  PublisherInfo publisher;
  publisher.name = "robot";
  publisher.silent = std::chrono::milliseconds(250);
  publisher.lost = true;
  publisher.applied_sequence = 14;
  status.publishers = {publisher};
  json expected{{"type", "status"},
                {"state", "ready"},
                {"version_text", "1.2.3"},
                {"pid", 4},
                {"namespace", "hall"},
                {"epoch", 5},
                {"world", 6},
                {"world_time", 1.5},
                {"scenes", {"a", "b"}},
                {"static_triangles", 9},
                {"objects", 10},
                {"moving", 11},
                {"contacts", 8},
                {"contacts_truncated", true},
                {"questions_answered", 12},
                {"undecided_answers", 13},
                {"step_lasting", 2.5},
                {"in_doubt", nullptr},
                {"publishers", {{{"name", "robot"}, {"messages", 14}, {"silent", 0.25}, {"lost", true}}}}};
  EXPECT_EQ(json::parse(status_text(status, std::nullopt)), expected);
  // Two seconds of it; of four steps three took at most 1 ms, of ten answers nine.
  Figures recent;
  recent.up_ns = 2'000'000'000;
  recent.steps = 4;
  recent.step_durations = {{1'000'000, 3}, {2'000'000, 1}};
  recent.stages = {{"pairs", 500'000'000}};
  recent.pairs = {.candidates = 20, .filtered = 6, .in_doubt = 15};
  recent.poses.applied = 30;
  expected["in_doubt"] = 15;
  recent.questions = {{"ray", 10, {{1'000'000, 9}, {4'000'000, 1}}}, {"pair", 0, {}}};
  expected["recent"] = {{"stages", {{{"stage", "pairs"}, {"share", 0.25}}}},
                        {"asked",
                         {{{"kind", "ray"}, {"rate", 5.0}, {"p50", 0.001}, {"p99", 0.004}},
                          {{"kind", "pair"}, {"rate", 0.0}, {"p50", nullptr}, {"p99", nullptr}}}},
                        {"steps", 2.0},
                        {"step_p50", 0.001},
                        {"step_p99", 0.002},
                        {"poses", 15.0},
                        {"candidates", 5.0},
                        {"filtered", 1.5}};
  EXPECT_EQ(json::parse(status_text(status, recent)), expected);
  // Without a step, and without time, nothing is divided by 0.
  const json idle = json::parse(status_text(status, Figures{}))["recent"];
  EXPECT_EQ(idle, (json{{"stages", json::array()},
                        {"asked", json::array()},
                        {"steps", 0.0},
                        {"step_p50", nullptr},
                        {"step_p99", nullptr},
                        {"poses", 0.0},
                        {"candidates", 0.0},
                        {"filtered", 0.0}}));
}

TEST(PageMessages, AnObjectIsToldInFull) {
  ObjectDetails object;
  object.name = "<b>\u202e";
  object.kind = "sphere";
  object.moving = true;
  object.publisher = "robot";
  object.layers = 2;
  object.mask = 3;
  object.pose = Pose{{1, 2, 3}, Quat::Identity()};
  object.age = std::chrono::milliseconds(250);
  object.contacts = {"floor"};
  const json told = json::parse(object_answer_text(9, object));
  EXPECT_EQ(told["ask"], "object");
  EXPECT_EQ(told["name"], "<b>\u202e");
  EXPECT_EQ(told["publisher"], "robot");
  EXPECT_EQ(told["mask"], 3);
  EXPECT_EQ(told["pose"], json({1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(told["age"], 0.25);
  EXPECT_EQ(told["contacts"], json({"floor"}));
  object.pose.reset();
  EXPECT_FALSE(json::parse(object_answer_text(9, object)).contains("pose")) << "a scene's part has none";
}

TEST(PageMessages, MovingObjectsAreToldByTheirPublishers) {
  const auto listed = [](std::uint64_t id, const char* publisher) {
    ListedObject object;
    object.id = id;
    object.publisher = publisher;
    return object;
  };
  ObjectList list{.objects = {listed(3, "robot"), listed((std::uint64_t{5} << 32) + 4, ""), listed(7, "robot")},
                  .count = 5,
                  .version = 1};
  const json told = json::parse(owners_answer_text(2, list));
  EXPECT_EQ(told["owners"], (json{{{"publisher", ""}, {"slots", {4}}}, {{"publisher", "robot"}, {"slots", {3, 7}}}}));
  EXPECT_EQ(told["left_out"], 2);
}

TEST(PageMessages, TheGreetingSaysHowACommandReachesTheServer) {
  const json told = json::parse(hello_text(true, "--domain 5 "));
  EXPECT_EQ(told["up"], "y");
  EXPECT_EQ(told["connection"], "--domain 5 ");
}

// As `collide ray --json` names them.
TEST(PageMessages, AnAnswerHasTheCommandLinesMembers) {
  Answer answer;
  answer.verdict = Verdict::hit;
  Hit hit;
  hit.object = "wall";
  hit.distance_m = 0.1 + 0.2;
  hit.point = {1, 2, std::numeric_limits<double>::infinity()};
  answer.hits = {hit};
  answer.cost = {.nodes = 7, .exact_tests = 2};
  Answers answers;
  answers.answers = {answer};
  answers.compute = std::chrono::microseconds(41);
  answers.oldest_pose_age = std::chrono::milliseconds(2);
  const json told = json::parse(ray_answer_text(7, {.origin = {0, 0, 5}, .direction = {0, 0, -1}}, answers));
  EXPECT_EQ(told["cost"], (json{{"nodes", 7}, {"exact_tests", 2}, {"compute", 41e-6}}));
  EXPECT_EQ(told["age"], 2e-3);
  EXPECT_EQ(told["id"], 7);
  EXPECT_EQ(told["distance"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(told["point"][2], "inf");
  EXPECT_FALSE(told.contains("triangle")) << "of a primitive";
  const json refused = json::parse(ray_answer_text(7, {}, Error{ErrorCode::timeout, "no answer", ""}));
  EXPECT_EQ(refused["type"], "refused");
  EXPECT_EQ(refused["why"], "no answer");
}

TEST(PageMessages, AnswersWithManyHitsTellTheFirstHundred) {
  Answers answers;
  Answer& answer = answers.answers.emplace_back();
  answer.verdict = Verdict::hit;
  answer.hits.resize(130);
  answer.hits[0].object = "wall";
  answer.hits[0].time_low = 0.25;
  answer.hits[0].time_high = 0.5;
  const json sphere = json::parse(hits_answer_text(3, "sphere", answers));
  EXPECT_EQ(sphere["ask"], "sphere");
  EXPECT_EQ(sphere["hits"].size(), 100);
  EXPECT_EQ(sphere["left_out"], 30);
  EXPECT_FALSE(sphere["hits"][0].contains("time_low")) << "only of sweeps";
  const json sweep = json::parse(hits_answer_text(3, "sweep", answers));
  EXPECT_EQ(sweep["hits"][0]["time_low"], 0.25);
  EXPECT_EQ(sweep["hits"][0]["time_high"], 0.5);
  answer.verdict = Verdict::undecided;
  answer.reason = UndecidedReason::stale_object;
  EXPECT_EQ(json::parse(hits_answer_text(3, "box", answers))["reason"], "stale_object");
}

TEST(PageMessages, TheNearestIsToldWithItsLine) {
  ClearanceAnswer answer;
  EXPECT_FALSE(json::parse(nearest_answer_text(4, "arm", answer)).contains("other")) << "nothing else is there";
  ClearancePair& pair = answer.pairs.emplace_back();
  pair.a = "arm";
  pair.b = "shelf";
  pair.clearance_m = 0.1 + 0.2;
  pair.on_b = {1, 2, 3};
  answer.late = true;
  const json told = json::parse(nearest_answer_text(4, "arm", answer));
  EXPECT_EQ(told["name"], "arm");
  EXPECT_EQ(told["other"], "shelf");
  EXPECT_EQ(told["clearance"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(told["on_b"], json({1.0, 2.0, 3.0}));
  EXPECT_TRUE(told["late"]) << "a nearer one may be missing";
}

TEST(PageAnswer, OfWhatOthersAskIsTheServersOwn) {
  const json told =
      json::parse(sampled_answer_text(9, std::string(R"({"questions":[{"kind":"ray"}],"since":12,"type":"hello"})")));
  EXPECT_EQ(
      told,
      (json{{"type", "answer"}, {"ask", "sampled"}, {"id", 9}, {"since", 12}, {"questions", {{{"kind", "ray"}}}}}));
  EXPECT_EQ(json::parse(sampled_answer_text(9, std::string("[]")))["type"], "refused");
  EXPECT_EQ(json::parse(sampled_answer_text(9, Error{.message = "no right", .hint = {}}))["why"], "no right");
}

TEST(PageQuestion, OfShapesAndPointsHasTheirNumbers) {
  const auto sphere = parse_page_question(R"({"ask":"sphere","id":1,"center":[1,2,3],"radius":0.25})");
  ASSERT_TRUE(sphere);
  EXPECT_EQ(std::get<SphereQuestion>(sphere->what).radius_m, 0.25);
  const auto box = parse_page_question(R"({"ask":"box","id":1,"center":[1,2,3],"half":[0,1,2]})");
  ASSERT_TRUE(box);
  EXPECT_EQ(std::get<BoxQuestion>(box->what).half_m, Vec3(0, 1, 2));
  const auto near = parse_page_question(R"({"ask":"near","id":1,"point":[1,2,3],"count":3})");
  ASSERT_TRUE(near);
  EXPECT_EQ(std::get<NearestToPoint>(near->what).count, 3);
  const auto sweep = parse_page_question(R"({"ask":"sweep","id":1,"radius":0.5,"from":[0,0,1],"to":[2,0,1]})");
  ASSERT_TRUE(sweep);
  EXPECT_EQ(std::get<SweptBall>(sweep->what).motion.to.position, Vec3(2, 0, 1));
  const auto nearest = parse_page_question(R"({"ask":"nearest","id":1,"name":"arm"})");
  ASSERT_TRUE(nearest);
  EXPECT_EQ(std::get<NearestToObject>(nearest->what).name, "arm");
  const auto memory = parse_page_question(R"({"ask":"memory","id":1,"seconds":30})");
  ASSERT_TRUE(memory);
  EXPECT_EQ(std::get<Remembered>(memory->what).last_s, 30);
  const auto sampled = parse_page_question(R"({"ask":"sampled","id":1,"since":41})");
  ASSERT_TRUE(sampled);
  EXPECT_EQ(std::get<SampledSince>(sampled->what).since, 41);
  for (const char* bad :
       {R"({"ask":"sampled","id":1})", R"({"ask":"sampled","id":1,"since":-1})",
        R"({"ask":"sampled","id":1,"since":1e300})", R"({"ask":"memory","id":1,"seconds":0})",
        R"({"ask":"memory","id":1,"seconds":1e6})", R"({"ask":"memory","id":1})",
        R"({"ask":"sphere","id":1,"center":[1,2,3],"radius":-1})", R"({"ask":"sphere","id":1,"center":[1,2,3]})",
        R"({"ask":"box","id":1,"center":[1,2,3],"half":[0,-1,2]})", R"({"ask":"near","id":1,"point":[1,2,3]})",
        R"({"ask":"near","id":1,"point":[1,2,3],"count":0})", R"({"ask":"near","id":1,"point":[1,2,3],"count":1e9})",
        R"({"ask":"sweep","id":1,"radius":0,"from":[0,0,1],"to":[2,0,1]})",
        R"({"ask":"sweep","id":1,"radius":1,"from":[0,0,1]})", R"({"ask":"nearest","id":1})"}) {
    EXPECT_FALSE(parse_page_question(bad)) << bad;
  }
}

TEST(PageQuestion, IsWhatItSaysOrNothing) {
  const auto ray = parse_page_question(R"({"ask":"ray","id":3,"origin":[0,0,5],"direction":[0,0,-1e-300]})");
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->id, 3);
  EXPECT_EQ(std::get<RayQuestion>(ray->what).direction.z(), -1e-300);
  const auto pair = parse_page_question(R"({"ask":"pair","id":4,"a":"x","b":"y"})");
  ASSERT_TRUE(pair);
  EXPECT_EQ(std::get<PairOfNames>(pair->what).b, "y");
  const auto object = parse_page_question(R"({"ask":"object","id":5,"name":"x"})");
  ASSERT_TRUE(object);
  EXPECT_EQ(std::get<ObjectOfName>(object->what).name, "x");
  const auto owners = parse_page_question(R"({"ask":"owners","id":6})");
  ASSERT_TRUE(owners);
  EXPECT_TRUE(std::holds_alternative<Owners>(owners->what));
  for (const char* bad :
       {R"({"ask":"object","id":5})", R"({"ask":"object","id":5,"name":""})", R"({"ask":"owners"})", "", "7", "[]", "{",
        R"({"ask":"ray"})", R"({"ask":"ray","id":3,"origin":[0,0],"direction":[0,0,1]})",
        R"({"ask":"ray","id":3,"origin":[0,0,5],"direction":[0,0,0]})",
        R"({"ask":"ray","id":3,"origin":[0,0,1e999],"direction":[0,0,1]})",
        R"({"ask":"ray","id":3,"origin":["0",0,5],"direction":[0,0,1]})",
        R"({"ask":"ray","id":"3","origin":[0,0,5],"direction":[0,0,1]})", R"({"ask":"add","id":3,"name":"x"})",
        R"({"ask":"pair","id":3,"a":"","b":"y"})", R"({"ask":7,"id":3})"}) {
    EXPECT_FALSE(parse_page_question(bad)) << bad;
  }
  EXPECT_FALSE(parse_page_question(R"({"ask":"pair","id":3,"b":"y","a":")" + std::string(256, 'x') + "\"}"));
  EXPECT_FALSE(parse_page_question(std::string(16'000, '['))) << "deep, and no question";
}

}  // namespace
}  // namespace collided::view
