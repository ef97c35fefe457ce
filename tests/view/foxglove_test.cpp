#include "client/view/foxglove.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <set>

#include <nlohmann/json.hpp>

#include "client/view/foxglove_scene.hpp"

namespace collided::view {
namespace {

using nlohmann::json;

ShownObject object(std::uint64_t id, const std::string& name, bool moving) {
  ShownObject one;
  one.id = id;
  one.name = name;
  one.moving = moving;
  return one;
}

class FoxgloveTest : public testing::Test {
 protected:
  struct Sent {
    Foxglove::Connection to;
    WebMessage message;
  };
  json text() {
    EXPECT_FALSE(sent.empty());
    if (sent.empty()) return {};
    const Sent first = sent.front();
    sent.pop_front();
    EXPECT_TRUE(first.message.is_text);
    return json::parse(*first.message.bytes);
  }
  /// A binary message: its subscription and its JSON.
  std::pair<std::uint32_t, json> data() {
    EXPECT_FALSE(sent.empty());
    if (sent.empty()) return {};
    const Sent first = sent.front();
    sent.pop_front();
    const std::string& bytes = *first.message.bytes;
    EXPECT_FALSE(first.message.is_text);
    EXPECT_EQ(bytes[0], 1);
    std::uint32_t subscription = 0;
    std::memcpy(&subscription, bytes.data() + 1, 4);
    std::memcpy(&time_ns, bytes.data() + 5, 8);
    return {subscription, json::parse(bytes.substr(13))};
  }
  void subscribe(std::uint32_t id, std::uint32_t channel) {
    foxglove.said(1, json{{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}}.dump(), true);
  }
  static std::shared_ptr<const ShownObjects> world() {
    auto shown = std::make_shared<ShownObjects>();
    shown->world_time = std::chrono::nanoseconds(1'500'000'007);
    ShownObject ball = object(9, "ball", true);
    ball.parts = {SphereShape{.radius_m = 0.25}};
    ShownObject crate = object(10, "crate", false);
    crate.pose.position = {1, 2, 3};
    crate.parts = {BoxShape{.half_m = {0.5, 1, 2}, .center = {1, 0, 0}}};
    shown->objects = {ball, crate};
    return shown;
  }
  static Poses poses(std::int64_t time_ns) {
    Poses poses;
    poses.world_time = std::chrono::nanoseconds(time_ns);
    poses.ids = {9, 77};
    poses.poses = {{.position = {4, 5, 6}, .rotation = Quat::Identity()}, {}};
    poses.stale = {0, 0};
    return poses;
  }

  std::deque<Sent> sent;
  std::int64_t time_ns = 0;
  Foxglove foxglove{[this](Foxglove::Connection to, const WebMessage& message) { sent.push_back({to, message}); }};
};

TEST_F(FoxgloveTest, TakesThePartOfTheProtocolThatItKnows) {
  EXPECT_EQ(Foxglove::protocol({"x", "foxglove.websocket.v1"}), "foxglove.websocket.v1");
  EXPECT_EQ(Foxglove::protocol({"foxglove.websocket.v1", "foxglove.sdk.v1"}), "foxglove.sdk.v1");
  EXPECT_EQ(Foxglove::protocol({"x"}), std::nullopt);
}

TEST_F(FoxgloveTest, AClientIsGreetedAndToldTheChannels) {
  foxglove.opened(1);
  const json info = text();
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_TRUE(info["capabilities"].is_array());
  const json channels = text()["channels"];
  ASSERT_EQ(channels.size(), 5U);
  for (const json& channel : channels) {
    EXPECT_EQ(channel["encoding"], "json");
    EXPECT_EQ(channel["schemaEncoding"], "jsonschema");
    EXPECT_TRUE(json::parse(channel["schema"].get<std::string>(), nullptr, false).is_object()) << channel["topic"];
  }
  EXPECT_EQ(channels[0]["schemaName"], "foxglove.SceneUpdate");
  EXPECT_EQ(channels[1]["schemaName"], "foxglove.FrameTransforms");
}

TEST_F(FoxgloveTest, TheSceneComesToWhoSubscribes) {
  foxglove.opened(1);
  sent.clear();
  foxglove.objects(world());
  EXPECT_TRUE(sent.empty()) << "no client has subscribed";
  subscribe(5, 1);
  const auto [subscription, scene] = data();
  EXPECT_EQ(subscription, 5U);
  EXPECT_EQ(time_ns, 1'500'000'007);
  ASSERT_EQ(scene["entities"].size(), 2U);
  const json& ball = scene["entities"][0];
  EXPECT_EQ(ball["frame_id"], "ball") << "what moves is a frame";
  EXPECT_EQ(ball["spheres"][0]["size"]["x"], 0.5) << "a diameter";
  EXPECT_EQ(ball["timestamp"], json({{"sec", 1}, {"nsec", 500'000'007}}));
  const json& crate = scene["entities"][1];
  EXPECT_EQ(crate["frame_id"], "world");
  EXPECT_EQ(crate["cubes"][0]["pose"]["position"], json({{"x", 2.}, {"y", 2.}, {"z", 3.}}));
  EXPECT_EQ(crate["cubes"][0]["size"]["z"], 4.);
}

TEST_F(FoxgloveTest, TransformsOfKnownFramesComeTenTimesASecond) {
  foxglove.opened(1);
  foxglove.objects(world());
  sent.clear();
  foxglove.poses(poses(2'000'000'000));
  EXPECT_TRUE(sent.empty());
  subscribe(6, 2);
  for (std::int64_t i = 0; i < 20; ++i) foxglove.poses(poses(2'000'000'000 + i * 10'000'000));
  EXPECT_EQ(sent.size(), 2U);
  const auto [subscription, transforms] = data();
  EXPECT_EQ(subscription, 6U);
  ASSERT_EQ(transforms["transforms"].size(), 1U) << "77 is in no table";
  EXPECT_EQ(transforms["transforms"][0]["child_frame_id"], "ball");
  EXPECT_EQ(transforms["transforms"][0]["translation"]["z"], 6);
  foxglove.said(1, R"({"op":"unsubscribe","subscriptionIds":[6]})", true);
  sent.clear();
  foxglove.poses(poses(9'000'000'000));
  EXPECT_TRUE(sent.empty());
}

TEST_F(FoxgloveTest, ContactsAreArrowsForASecond) {
  foxglove.opened(1);
  subscribe(1, 3);
  subscribe(2, 4);
  sent.clear();
  Event began;
  began.kind = EventKind::began;
  began.a = "a";
  began.b = "b";
  began.normal = {0, 0, 1};
  began.point = {1, 1, 1};
  Event ended = began;
  ended.kind = EventKind::ended;
  foxglove.events(std::vector<Event>{began, ended});
  const json update = data().second;
  ASSERT_EQ(update["entities"].size(), 1U);
  EXPECT_EQ(update["entities"][0]["lifetime"]["sec"], 1);
  EXPECT_EQ(update["entities"][0]["arrows"].size(), 1U);
  EXPECT_EQ(data().second["what"], "began");
  EXPECT_EQ(data().second["what"], "ended");
}

// In the frame of what moves, in the world for what stands still there; a later subscriber receives them too.
TEST_F(FoxgloveTest, StandingQuestionsAreLinesThatAreLitWhileTheyHoldSomething) {
  foxglove.opened(1);
  foxglove.objects(world());
  sent.clear();
  std::vector<draw::StandingOutline> outlines(4);
  for (draw::StandingOutline& outline : outlines) outline.lines = {{0, 0, 0, 1, 0, 0}};
  outlines[0].name = "dock";
  outlines[0].holds = {{.object = "ball"}};
  outlines[1].name = "close";
  outlines[1].form = StandingForm::bands;
  outlines[1].about = "ball";
  outlines[1].band_m = 2;
  outlines[2].name = "zone";
  outlines[2].to = "crate";
  outlines[3].name = "escape";
  outlines[3].form = StandingForm::nearest;
  outlines[3].to = "crate";
  outlines[3].holds = {{.object = "ball"}};
  outlines[3].distance_m = 1;
  foxglove.standing(outlines);
  EXPECT_TRUE(sent.empty()) << "no client has subscribed";
  subscribe(4, 5);
  const json update = data().second;
  EXPECT_EQ(update["deletions"].size(), 1U) << "those that are gone";
  ASSERT_EQ(update["entities"].size(), 4U);
  const json& dock = update["entities"][0];
  EXPECT_EQ(dock["frame_id"], "world");
  EXPECT_EQ(dock["lines"][0]["points"].size(), 2U);
  const json& band = update["entities"][1];
  EXPECT_EQ(band["frame_id"], "ball");
  EXPECT_EQ(band["id"], "close ball 2.0");
  EXPECT_NE(band["lines"][0]["color"], dock["lines"][0]["color"]);
  EXPECT_LT(band["lines"][0]["thickness"], dock["lines"][0]["thickness"]);
  const json& zone = update["entities"][2];
  EXPECT_EQ(zone["frame_id"], "world");
  EXPECT_EQ(zone["lines"][0]["points"][0], json({{"x", 1.}, {"y", 2.}, {"z", 3.}}));
  EXPECT_TRUE(zone["texts"].empty());
  // The line to what is nearest is in the world, with its length in the middle.
  const json& escape = update["entities"][3];
  EXPECT_EQ(escape["frame_id"], "world");
  EXPECT_EQ(escape["lines"][0]["points"][0], json({{"x", 0.}, {"y", 0.}, {"z", 0.}}));
  EXPECT_EQ(escape["texts"][0]["text"], "escape 1 m");
  EXPECT_EQ(escape["texts"][0]["pose"]["position"], json({{"x", 0.5}, {"y", 0.}, {"z", 0.}}));
  EXPECT_EQ(escape["lines"][0]["color"], dock["lines"][0]["color"]);
}

// Scenes are large: while one waits for a client, a newer one of the same subscription takes its place, and of no other.
TEST_F(FoxgloveTest, ScenesTransformsAndStandingQuestionsReplaceEarlierOnesThatWait) {
  foxglove.opened(1);
  foxglove.objects(world());
  sent.clear();
  for (const std::uint32_t id : {1U, 2U}) {
    for (const std::uint32_t channel : {1U, 2U, 5U}) subscribe(10 * id + channel, channel);
  }
  for (const std::uint32_t channel : {3U, 4U}) subscribe(channel, channel);
  sent.clear();
  foxglove.objects(world());
  foxglove.poses(poses(2'000'000'000));
  foxglove.standing({});
  std::set<std::uint8_t> lanes;
  for (const Sent& one : sent) EXPECT_TRUE(lanes.insert(one.message.lane).second) << "two subscriptions share a lane";
  EXPECT_EQ(lanes.size(), 6U);
  EXPECT_FALSE(lanes.contains(0)) << "none accumulates";
  sent.clear();
  Event began;
  began.kind = EventKind::began;
  began.normal = {0, 0, 1};
  foxglove.events(std::vector<Event>{began});
  ASSERT_EQ(sent.size(), 2U);
  for (const Sent& one : sent) EXPECT_EQ(one.message.lane, 0) << "every event is sent";
}

TEST_F(FoxgloveTest, WhatItDoesNotKnowIsAnsweredWithAWarning) {
  foxglove.opened(1);
  sent.clear();
  for (const char* bad :
       {"", "7", "{}", R"({"op":7})", R"({"op":"advertise","channels":[]})",
        R"({"op":"subscribe","subscriptions":[7]})", R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})"}) {
    foxglove.said(1, bad, true);
    EXPECT_EQ(text()["level"], 1) << bad;
  }
  foxglove.said(1, "\1\2\3", false);
  EXPECT_EQ(text()["level"], 1);
  for (std::uint32_t id = 0; id < 200; ++id) subscribe(id, 4);
  EXPECT_EQ(sent.size(), 200U - 64U) << "so many subscriptions at most";
  sent.clear();
  foxglove.closed(1);
  foxglove.events(std::vector<Event>(1));
  EXPECT_TRUE(sent.empty());
}

// What moves is dark, what stands is light, whatever it is made of.
TEST(FoxgloveScene, EveryKindOfPartHasItsPlaceSizeAndColor) {
  const auto surface = std::make_shared<Surface>();
  surface->vertices = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}};
  surface->triangles = {{0, 1, 2}, {0, 1, 3}};
  ShownObject still = object(1, "all", false);
  still.parts = {SphereShape{.radius_m = 0.25, .center = {1, 2, 3}},
                 EllipsoidShape{.half_m = {1, 2, 3}, .center = {4, 5, 6}},
                 BoxShape{.half_m = {0.5, 1, 2}, .center = {7, 8, 9}},
                 CylinderShape{.a = {0, 0, 1}, .b = {0, 0, 5}, .radius_m = 2},
                 ConeShape{.apex = {0, 0, 7}, .base = {0, 0, 4}, .radius_m = 1},
                 CapsuleShape{.a = {1, 1, 1}, .b = {1, 1, 3}, .radius_m = 0.5},
                 CapsuleShape{.a = {2, 2, 2}, .b = {2, 2, 2}, .radius_m = 3},
                 HalfSpaceShape{}};
  still.runs = {{.surface = surface, .first_triangle = 1, .triangle_count = 1}};
  const auto point = [](double x, double y, double z) { return json{{"x", x}, {"y", y}, {"z", z}}; };
  const json upright{{"x", 0.}, {"y", 0.}, {"z", 0.}, {"w", 1.}};
  const auto part = [&](const json& center, const json& size, const json& color) {
    return json{{"pose", {{"position", center}, {"orientation", upright}}}, {"size", size}, {"color", color}};
  };
  const auto tube = [&](const json& center, const json& size, double top_scale, const json& color) {
    json one = part(center, size, color);
    one["bottom_scale"] = 1;
    one["top_scale"] = top_scale;
    return one;
  };
  for (const bool moving : {false, true}) {
    still.moving = moving;
    const json color = moving ? json{{"r", 0.36}, {"g", 0.36}, {"b", 0.35}, {"a", 1}}
                              : json{{"r", 0.78}, {"g", 0.77}, {"b", 0.74}, {"a", 1}};
    const json entity = json::parse(scene_update({.objects = {still}}))["entities"][0];
    EXPECT_EQ(entity["id"], "all");
    EXPECT_EQ(entity["frame_id"], moving ? "all" : "world");
    EXPECT_EQ(entity["frame_locked"], true);
    EXPECT_EQ(entity["lifetime"], json({{"sec", 0}, {"nsec", 0}}));
    EXPECT_EQ(entity["spheres"],
              json({part(point(1, 2, 3), point(0.5, 0.5, 0.5), color), part(point(4, 5, 6), point(2, 4, 6), color),
                    part(point(1, 1, 1), point(1, 1, 1), color), part(point(1, 1, 3), point(1, 1, 1), color),
                    part(point(2, 2, 2), point(6, 6, 6), color), part(point(2, 2, 2), point(6, 6, 6), color)}));
    EXPECT_EQ(entity["cubes"], json::array({part(point(7, 8, 9), point(1, 2, 4), color)}));
    ASSERT_EQ(entity["cylinders"].size(), 3u);
    EXPECT_EQ(entity["cylinders"][0], tube(point(0, 0, 3), point(4, 4, 4), 1, color));
    EXPECT_EQ(entity["cylinders"][1], tube(point(0, 0, 5.5), point(2, 2, 3), 0, color));
    EXPECT_EQ(entity["cylinders"][2], tube(point(1, 1, 2), point(1, 1, 2), 1, color));
    ASSERT_EQ(entity["triangles"].size(), 1u);
    EXPECT_EQ(entity["triangles"][0]["points"], json({point(0, 0, 0), point(2, 0, 0), point(0, 0, 6)}));
    EXPECT_EQ(entity["triangles"][0]["indices"], json({0, 1, 2}));
    EXPECT_EQ(entity["triangles"][0]["color"], color);
    for (const char* none : {"metadata", "arrows", "lines", "texts", "models"})
      EXPECT_EQ(entity[none], json::array()) << none;
  }
}

TEST(FoxgloveScene, TooManyTrianglesBecomeABox) {
  const auto surface = std::make_shared<Surface>();
  surface->vertices = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}};
  surface->triangles = {{0, 1, 2}, {0, 1, 3}};
  ShownObject mesh = object(1, "mesh", true);
  mesh.runs = {{.surface = surface, .first_triangle = 0, .triangle_count = 2}};
  const ShownObjects shown{.objects = {mesh, mesh}};
  const json whole = json::parse(scene_update(shown, {.of_object = 2, .of_scene = 4}))["entities"];
  EXPECT_EQ(whole[1]["triangles"][0]["points"].size(), 4U) << "each point once";
  EXPECT_EQ(whole[1]["triangles"][0]["indices"], json({0, 1, 2, 0, 1, 3}));
  const json bounds = json::parse(scene_update(shown, {.of_object = 1, .of_scene = 4}))["entities"];
  EXPECT_TRUE(bounds[0]["triangles"].empty());
  EXPECT_EQ(bounds[0]["cubes"][0]["size"]["z"], 6.);
  const json mixed = json::parse(scene_update(shown, {.of_object = 2, .of_scene = 3}))["entities"];
  EXPECT_EQ(mixed[0]["cubes"].size(), 0U);
  EXPECT_EQ(mixed[1]["cubes"].size(), 1U) << "the scene has too many";
}

}  // namespace
}  // namespace collided::view
