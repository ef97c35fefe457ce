// The commands as C++ programs give them: what they say is what is in the world, and what cannot be done says why.
#include <fstream>
#include <limits>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

class ServerTypedCommands : public testing_support::ServerTest {
 protected:
  void SetUp() override { start(); }
  static ObjectOptions ball(const std::string& name, const Vec3& at) {
    ObjectOptions object{.name = name, .shape = {SphereShape{.radius_m = 0.5}}};
    object.pose.position = at;
    return object;
  }
  template <class T>
  static T must(Result<T> result) {
    EXPECT_TRUE(result) << result.error().message;
    return result ? std::move(*result) : T{};
  }
  std::string write_roof() { return folder_.write("roof.obj", "v -9 -9 6\nv 9 -9 6\nv 9 9 6\nv -9 9 6\nf 1 2 3 4\n"); }
};

// A side without end is null in the answer, and was refused as no number.
TEST_F(ServerTypedCommands, APlanesBoundsHaveNoEnd) {
  Client client = connect();
  ObjectOptions ground{.name = "ground", .shape = {HalfSpaceShape{}}};
  ground.moving = false;
  must(client.add(ground));
  const ObjectDetails details = must(client.get("ground"));
  EXPECT_EQ(details.bounds[0].x(), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(details.bounds[1].x(), std::numeric_limits<double>::infinity());
}

TEST_F(ServerTypedCommands, WhatIsAddedIsListedMovedAndRemoved) {
  Client client = connect();
  ObjectOptions object = ball("ball", {0, 0, 20});
  object.layers = 6;
  object.mask = 7;
  object.group = 3;
  object.scale = {2, 2, 2};
  const Added added = must(client.add(object));
  const ObjectDetails details = must(client.get("ball"));
  EXPECT_EQ(details.name, "ball");
  EXPECT_EQ(details.id, added.id);
  EXPECT_EQ(details.kind, "sphere");
  EXPECT_TRUE(details.moving);
  EXPECT_EQ(details.scene, "");
  EXPECT_EQ(details.publisher, "");
  EXPECT_EQ(details.layers, 6U);
  EXPECT_EQ(details.mask, 7U);
  EXPECT_EQ(details.group, 3U);
  ASSERT_TRUE(details.pose);
  EXPECT_EQ(details.pose->position, Vec3(0, 0, 20));
  EXPECT_NEAR(details.bounds[0].z(), 19, 1e-9) << "scaled to a radius of 1";
  EXPECT_NEAR(details.bounds[1].z(), 21, 1e-9);
  EXPECT_TRUE(details.contacts.empty());

  must(client.add(ball("other", {5, 0, 20})));
  const Pose beside{.position = {4, 0, 20}, .rotation = Quat(0.5, 0.5, 0.5, 0.5)};
  const Moved moved = must(client.move("ball", beside));
  EXPECT_NEAR(moved.distance_m, 4, 1e-12);
  EXPECT_EQ(moved.began, std::vector<std::string>{"other"});
  EXPECT_TRUE(moved.ended.empty());
  EXPECT_GT(moved.version, added.version);
  EXPECT_EQ(must(client.get("ball")).pose->rotation.coeffs(), beside.rotation.coeffs());
  EXPECT_EQ(must(client.get("other")).contacts, std::vector<std::string>{"ball"});
  EXPECT_EQ(must(client.move("ball", {.position = {0, 0, 20}}, true)).ended, std::vector<std::string>{"other"});

  const ObjectList movers = must(client.list({.moving = true}));
  EXPECT_EQ(movers.count, 2U);
  const ObjectList one = must(client.list({.name = "b*", .moving = true, .limit = 1}));
  ASSERT_EQ(one.objects.size(), 1U);
  EXPECT_EQ(one.objects[0].name, "ball");
  EXPECT_EQ(must(client.list({.moving = true, .limit = 1})).objects.size(), 1U);
  EXPECT_GT(must(client.list({.moving = false})).count, 0U);

  must(client.move("ball", {.position = {4, 0, 20}}, true));
  const Removed removed = must(client.remove("*a*l"));
  EXPECT_EQ(removed.names, std::vector<std::string>{"ball"});
  EXPECT_EQ(removed.contacts_ended, 1U);
  EXPECT_EQ(must(client.list({.moving = true})).count, 1U);
  const Cleared cleared = must(client.clear({.moving = true}));
  EXPECT_EQ(cleared.removed, 1U);
  EXPECT_EQ(cleared.kept, 0U);
  EXPECT_EQ(must(client.list({.moving = true})).count, 0U);
}

TEST_F(ServerTypedCommands, AFileIsLoadedByPathOrByItsBytes) {
  Client client = connect();
  const std::string path = write_roof();
  const Loaded loaded = must(client.load(
      path,
      {.name = "roof", .unit_m = 2, .covers = {{{-20, -20, -1}, {20, 20, std::numeric_limits<double>::infinity()}}}},
      [&](double now) { EXPECT_TRUE(now >= 0 && now <= 1); }));
  EXPECT_EQ(loaded.scene, "roof");
  EXPECT_EQ(loaded.triangles, 2U);
  EXPECT_EQ(loaded.parts, 1U);
  ASSERT_EQ(loaded.covers.size(), 1U);
  EXPECT_EQ(loaded.covers[0].low, Vec3(-20, -20, -1));
  EXPECT_EQ(loaded.covers[0].high.z(), std::numeric_limits<double>::infinity());
  const Result<Answer> up = client.ask(RayQuestion{.origin = {0, 0, 11}, .direction = {0, 0, 1}, .length_m = 5});
  ASSERT_TRUE(up);
  ASSERT_EQ(up->hits.size(), 1U);
  EXPECT_EQ(up->hits[0].distance_m, 1) << "two metres a unit";

  std::ifstream file(path);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(client.load(std::as_bytes(std::span(text)), "roof.obj").error().code, ErrorCode::refused)
      << "the name is taken";
  EXPECT_EQ(must(client.load(std::as_bytes(std::span(text)), "roof.obj", {.replace = true})).triangles, 2U);
  EXPECT_EQ(must(client.clear({.scene = "roof"})).removed, 1U);
}

TEST_F(ServerTypedCommands, WhatCannotBeDoneSaysWhy) {
  Client client = connect();
  must(client.add(ball("ball", {0, 0, 20})));
  const auto refused = [](const auto& result) { return result ? std::string() : result.error().message; };
  EXPECT_NE(refused(client.add(ball("ball", {9, 0, 20}))).find("ball"), std::string::npos);
  EXPECT_NE(refused(client.add(ball("bad\xff", {9, 0, 20}))).find("not UTF-8"), std::string::npos);
  EXPECT_NE(refused(client.move("nobody", {})).find("nobody"), std::string::npos);
  EXPECT_NE(refused(client.move("ball", {.position = {0, 0, std::numeric_limits<double>::quiet_NaN()}})), "");
  EXPECT_EQ(must(client.get("ball")).pose->position, Vec3(0, 0, 20)) << "and nothing was done";
  EXPECT_NE(refused(client.remove("nobody")).find("nobody"), std::string::npos);
  EXPECT_NE(refused(client.get("nobody")).find("nobody"), std::string::npos);
  EXPECT_NE(refused(client.load("/no/such/file.obj")).find("/no/such/file.obj"), std::string::npos);
  EXPECT_NE(refused(client.clear({.scene = "nowhere"})).find("nowhere"), std::string::npos);
  Result<Publisher> publisher = client.publish("robot");
  ASSERT_TRUE(publisher);
  ASSERT_TRUE(publisher->add(ball("arm", {0, 5, 20})));
  ASSERT_TRUE(publisher->wait_applied(std::chrono::seconds(5)));
  EXPECT_NE(refused(client.move("arm", {})).find("robot"), std::string::npos) << "whose it is";
  EXPECT_EQ(must(client.get("arm")).publisher, "robot");
  EXPECT_EQ(must(client.clear({.moving = true})).kept, 1U);
}

TEST_F(ServerTypedCommands, ThePlanIsOfThisWorld) {
  Client client = connect();
  const auto built = [&](const std::string& structure) {
    for (const PlannedStructure& row : must(client.plan()).structures) {
      if (row.structure == structure) return row.built ? 1 : 0;
    }
    return -1;
  };
  EXPECT_EQ(built("bvh (static)"), 1);
  EXPECT_FALSE(must(client.plan()).pairs.empty());
  EXPECT_GT(must(client.plan()).bytes, 0U);
  must(client.clear());
  EXPECT_EQ(built("bvh (static)"), 0);
}

// One is asked for, so one comes; more by the option.
TEST_F(ServerTypedCommands, ANearestQuestionGivesTheNearest) {
  Client client = connect();
  must(client.clear());
  for (int i = 0; i < 5; ++i) must(client.add(ball("ball " + std::to_string(i), {3.0 * i, 0, 0})));
  const auto nearest = [&](const AskOptions& options) {
    const Result<Answer> answer = client.ask(NearQuestion{.point = {-1, 0, 0}}, options);
    EXPECT_TRUE(answer);
    std::vector<std::string> names;
    if (answer)
      for (const Hit& hit : answer->hits) names.push_back(hit.object);
    return names;
  };
  EXPECT_EQ(nearest({}), std::vector<std::string>{"ball 0"});
  EXPECT_EQ(nearest({.max_hits = 3}), (std::vector<std::string>{"ball 0", "ball 1", "ball 2"}));
  const std::vector<RayQuestion> rays(3, {.origin = {-5, 0, 0}, .direction = {1, 0, 0}});
  const Result<Answers> batch = client.ask(rays, {.mode = HitMode::all});
  ASSERT_TRUE(batch);
  ASSERT_EQ(batch->answers.size(), 3U);
  EXPECT_EQ(batch->answers[2].hits.size(), 5U);
  EXPECT_EQ(client.ask_async(rays).get()->answers[1].hits.size(), 1U);
}

}  // namespace
}  // namespace collided
