// Objects that move along with others, in the world and over a kill; robots thought elsewhere; what publishers declare solid.
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include <collided/robot.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerAttach : public testing_support::ServerTest {
 protected:
  static ObjectOptions box(const std::string& name, const Vec3& place, bool moving = true) {
    ObjectOptions object;
    object.name = name;
    object.shape = {BoxShape{.half_m = {0.5, 0.5, 0.5}}};
    object.pose.position = place;
    object.moving = moving;
    return object;
  }
  static void add(Client& client, const std::string& name, const Vec3& place, bool moving = true) {
    const Result<Added> added = client.add(box(name, place, moving));
    ASSERT_TRUE(added) << added.error().message;
  }
  static std::string why_not(Client& client, const std::string& child, const std::string& parent) {
    const Result<Attached> attached = client.attach(child, parent);
    return attached ? std::string() : attached.error().message;
  }
  static Vec3 place_of(Client& client, const std::string& name) {
    const Result<ObjectDetails> object = client.get(name);
    EXPECT_TRUE(object) << object.error().message;
    return object && object->position ? *object->position : Vec3(0, 0, 0);
  }
};

TEST_F(ServerAttach, AnAttachedObjectMovesWithThePublishersObjectAndIsToldSo) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "robot");
  const Result<Publisher::Object> hand = publisher.add(box("robot/hand", {0, 0, 100}));
  ASSERT_TRUE(hand);
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  add(client, "crate", {2, 0, 100});
  add(client, "post", {6, 0, 100}, false);
  Result<Watch> watching = client.watch({.only = "crate"});
  ASSERT_TRUE(watching && test::eventually([&] { return watching->in_step(); }));
  ASSERT_EQ(why_not(client, "crate", "robot/hand"), "");
  EXPECT_EQ(client.get("crate")->attached_to, "robot/hand");
  EXPECT_EQ(client.list({.name = "crate"})->objects[0].attached_to, "robot/hand");
  // Over the post and beyond it, in one motion: what is carried is swept.
  ASSERT_TRUE(publisher.move(*hand, at(10, 0, 100)));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  EXPECT_EQ(place_of(client, "crate"), Vec3(12, 0, 100));
  std::vector<Event> told;
  ASSERT_TRUE(test::eventually([&] {
    while (std::optional<Event> event = watching->next(10ms)) told.push_back(*event);
    return told.size() >= 2;
  }));
  EXPECT_EQ(told[0].kind, EventKind::began);
  EXPECT_EQ(told[1].kind, EventKind::ended);
  EXPECT_EQ(told[1].reason, EndReason::separated);

  EXPECT_EQ(client.move("crate", at(0, 0, 0)).error().message,
            "server refused: object 'crate' is attached to 'robot/hand', which moves it");
  EXPECT_EQ(why_not(client, "robot/hand", "crate"),
            "server refused: object 'robot/hand' cannot be attached: publisher 'robot' moves it");
  EXPECT_EQ(why_not(client, "post", "robot/hand"),
            "server refused: object 'post' cannot be attached: it was added as "
            "static and stays where it is. Nothing was attached");
  EXPECT_NE(why_not(client, "crate", "robot/hnd").find("nearest names: robot/hand"), std::string::npos);
  const Result<Attached> free = client.detach("crate");
  ASSERT_TRUE(free);
  EXPECT_EQ(free->parent, "robot/hand");
  EXPECT_EQ(client.detach("crate").error().message, "server refused: object 'crate' is not attached to anything");
  EXPECT_EQ(client.get("crate")->attached_to, "");
  ASSERT_TRUE(client.move("crate", at(12, 2, 100)));
}

TEST_F(ServerAttach, ItEndsWithItsParentAndAClaimWaitsForIt) {
  start();
  Client client = connect();
  add(client, "hand", {0, 0, 100});
  add(client, "crate", {2, 0, 100});
  ASSERT_EQ(why_not(client, "crate", "hand"), "");
  EXPECT_EQ(why_not(client, "hand", "crate"),
            "server refused: object 'hand' cannot be attached: 'crate' moves along with it. Nothing was attached");
  Publisher publisher = publish(client, "robot");
  ASSERT_TRUE(publisher.claim("crate", at(2, 0, 100)));
  EXPECT_EQ(publisher.wait_applied(5s).error().message,
            "object 'crate' is not in the world: it is attached to 'hand', and moves along with that");
  ASSERT_TRUE(client.move("hand", at(5, 0, 100)));
  EXPECT_EQ(place_of(client, "crate"), Vec3(7, 0, 100));
  const Result<std::string> removed = client.command("remove", R"({"name": "hand"})");
  ASSERT_TRUE(removed);
  EXPECT_EQ(nlohmann::json::parse(*removed)["detached"], nlohmann::json::array({"crate"}));
  EXPECT_TRUE(test::eventually([&] { return static_cast<bool>(publisher.wait_applied(20s)); }));
  EXPECT_EQ(client.get("crate")->publisher, "robot");
}

// The parent comes back with its publisher, somewhere else; what is attached comes back with it, in its place there.
TEST_F(ServerAttach, AttachmentsOutliveAKillAndWaitForThePublisher) {
  start();
  std::optional<Client> client(connect());
  Publisher publisher = publish(*client, "robot");
  const Result<Publisher::Object> hand = publisher.add(box("robot/hand", {0, 0, 100}));
  ASSERT_TRUE(hand && publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  add(*client, "crate", {2, 0, 100});
  add(*client, "label", {2, 2, 100});
  add(*client, "free", {9, 9, 100});
  add(*client, "lost", {20, 0, 100});
  add(*client, "gone", {30, 0, 100});
  for (const auto& [child, parent] : std::vector<std::pair<std::string, std::string>>{
           {"crate", "robot/hand"}, {"label", "crate"}, {"free", "crate"}, {"lost", "gone"}})
    ASSERT_EQ(why_not(*client, child, parent), "");
  ASSERT_TRUE(publisher.move(*hand, at(0, 5, 100)));
  ASSERT_TRUE(publisher.flush() && publisher.wait_applied(20s));
  ASSERT_TRUE(client->detach("free"));
  ASSERT_TRUE(client->remove("gone"));
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  start({}, "server 2");
  ASSERT_TRUE(test::eventually(
      [&] {
        static_cast<void>(publisher.keep_alive());
        const Result<ObjectDetails> crate = client->get("crate", 1s);
        return crate && crate->attached_to == "robot/hand";
      },
      20s));
  EXPECT_EQ(place_of(*client, "crate"), Vec3(2, 5, 100));
  EXPECT_EQ(place_of(*client, "label"), Vec3(2, 7, 100));
  EXPECT_EQ(client->get("label")->attached_to, "crate");
  EXPECT_EQ(place_of(*client, "free"), Vec3(9, 14, 100));
  EXPECT_EQ(client->get("free")->attached_to, "");
  EXPECT_EQ(client->get("lost")->attached_to, "");
  ASSERT_TRUE(publisher.move(*hand, at(1, 5, 100)));
  ASSERT_TRUE(publisher.flush() && publisher.wait_applied(20s));
  EXPECT_EQ(place_of(*client, "crate"), Vec3(3, 5, 100));
}

TEST_F(ServerAttach, WhatIfHeedsWhatIsAttachedInTheWorld) {
  start();
  Client client = connect();
  add(client, "hand", {0, 0, 100});
  add(client, "crate", {0, 0, 102});
  add(client, "wall", {5, 0, 102});
  const WhatIfConfigurations thought{.objects = {"hand"}, .poses = {at(5, 0, 100)}};
  EXPECT_EQ(client.what_if(thought, {.against = "wall"})->configurations[0].verdict, Verdict::miss);
  ASSERT_EQ(why_not(client, "crate", "hand"), "");
  const Result<WhatIfAnswers> held = client.what_if(thought, {.against = "wall"});
  ASSERT_TRUE(held);
  EXPECT_EQ(held->configurations[0].verdict, Verdict::hit);
  EXPECT_EQ(held->configurations[0].nearest->a, "crate");
}

TEST_F(ServerAttach, ARobotIsThoughtElsewhereByItsJoints) {
  start();
  Client client = connect();
  const std::string arm = std::string(COLLIDED_SOURCE_DIR) + "/deploy/examples/arm.urdf";
  const Robot robot = *Robot::read(arm);
  const JointConfigurations plan{.joints = {"shoulder", "elbow"}, .positions = {0, 0, 0.4, 0.8, 1.2, 0.9, -1, 2}};
  EXPECT_EQ(what_if(client, robot, plan).error().message, "no link of robot 'arm' is in the world as 'arm/LINK'");
  ASSERT_TRUE(client.load(arm, {.moving = true}));
  add(client, "bench", {1, 0, 0.2}, false);
  const RobotPlace place{.base = at(0.1, 0.02, 0.2)};
  const WhatIfOptions options{.against = "bench", .with_clearance = true};
  const Result<WhatIfAnswers> by_joints = what_if(client, robot, plan, place, options);
  ASSERT_TRUE(by_joints) << by_joints.error().message;
  const RobotObjects links = *robot_objects(client, robot);
  EXPECT_EQ(links.names.size(), 4U);
  WhatIfConfigurations poses{.objects = links.names, .poses = {}};
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<double> positions;
    ASSERT_TRUE(robot.set(
        std::vector<JointValue>{{"shoulder", plan.positions[2 * i]}, {"elbow", plan.positions[2 * i + 1]}}, positions));
    const std::vector<Pose> all = robot.link_poses(positions, place.base);
    for (const std::size_t link : links.links) poses.poses.push_back(all[link]);
  }
  const Result<WhatIfAnswers> by_poses = client.what_if(poses, options);
  ASSERT_TRUE(by_poses);
  std::set<Verdict> verdicts;
  for (std::size_t i = 0; i < 4; ++i) {
    verdicts.insert(by_joints->configurations[i].verdict);
    EXPECT_EQ(by_joints->configurations[i].verdict, by_poses->configurations[i].verdict);
    EXPECT_EQ(by_joints->configurations[i].nearest->clearance_m, by_poses->configurations[i].nearest->clearance_m);
  }
  EXPECT_EQ(verdicts.size(), 2U);
  const JointConfigurations beyond{.joints = {"shoulder"}, .positions = {0.1, 3}};
  EXPECT_NE(what_if(client, robot, beyond).error().message.find("configuration 1: joint 'shoulder': 3 rad is beyond"),
            std::string::npos);
  EXPECT_TRUE(what_if(client, robot, beyond, {.beyond_limits = true}));
  EXPECT_FALSE(what_if(client, robot, {.joints = {"shoulder"}, .positions = {}}));
}

// What is not covered may hold something nearer; a question between two groups is about these alone.
TEST_F(ServerAttach, ClearanceOfEverythingElseLooksAtWhatIsCovered) {
  start({"--covers", "-10,-10,90:10,10,110"});
  Client client = connect();
  add(client, "a", {0, 0, 100});
  add(client, "b", {4, 0, 100});
  const Result<ClearanceAnswer> near = client.clearance("a", {.nearer_m = 4});
  ASSERT_TRUE(near);
  EXPECT_EQ(near->verdict, Verdict::miss);
  EXPECT_FALSE(near->uncovered);
  EXPECT_EQ(client.clearance("a")->verdict, Verdict::miss) << "b is nearer than what is not covered";
  const Result<ClearanceAnswer> far = client.clearance("a", {.most = 9, .nearer_m = 12});
  EXPECT_EQ(far->verdict, Verdict::undecided);
  EXPECT_EQ(far->reason, UndecidedReason::not_covered);
  EXPECT_TRUE(far->uncovered);
  EXPECT_EQ(client.clearance("a", {.to = "b", .nearer_m = 12})->verdict, Verdict::miss);
  add(client, "c", {0.5, 0, 100});
  const Result<ClearanceAnswer> touching = client.clearance("a", {.most = 9, .nearer_m = 12});
  EXPECT_EQ(touching->verdict, Verdict::hit);
  EXPECT_TRUE(touching->uncovered);
}

TEST_F(ServerAttach, QuestionsAboutThePastSeeTheRulesOfNow) {
  start();
  Client client = connect();
  add(client, "a", {0, 0, 100});
  add(client, "b", {0.5, 0, 100});
  ASSERT_TRUE(client.move("a", at(0, 0.1, 100)));
  const ClearanceOptions past{.to = "b", .as_of = {.kind = Instant::Kind::settled}};
  EXPECT_EQ(client.clearance("a", past)->verdict, Verdict::hit);
  const Result<RuleChanged> allowed = client.allow("a", "b", "a grip");
  ASSERT_TRUE(allowed);
  EXPECT_EQ(allowed->contacts, 1U);
  EXPECT_EQ(client.rules()->at(0).because, "a grip");
  EXPECT_EQ(client.clearance("a", {.to = "b"})->filtered, 1U);
  const Result<ClearanceAnswer> before = client.clearance("a", past);
  ASSERT_TRUE(before) << before.error().message;
  EXPECT_EQ(before->verdict, Verdict::miss);
  EXPECT_EQ(before->filtered, 1U);
  EXPECT_EQ(client.deny("a", "b")->contacts, 1U);
  EXPECT_EQ(client.clearance("a", past)->verdict, Verdict::hit);
}

TEST_F(ServerAttach, APublishersMeshIsSolidWhereItCloses) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "cutter");
  MeshShape tetrahedron{.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}},
                        .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  ObjectOptions object;
  object.name = "closed";
  object.pose.position = {0, 0, 100};
  object.shape = {tetrahedron};
  object.solid = true;
  ASSERT_TRUE(publisher.add(object));
  ASSERT_TRUE(publisher.flush());
  const Result<void> applied = publisher.wait_applied(5s);
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_TRUE(client.get("closed")->solid);
  EXPECT_EQ(client.inside({0.2, 0.2, 100.2})->hits.size(), 1U);
  tetrahedron.triangles.pop_back();
  object.name = "open";
  object.shape = {tetrahedron};
  const Result<Publisher::Object> open = publisher.add(object);
  ASSERT_TRUE(open);
  const Result<void> refused = publisher.wait_applied(5s);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_EQ(refused.error().message.find("object 'open' is not in the world: it is not solid: "), 0U)
      << refused.error().message;
  ASSERT_TRUE(publisher.remove(*open));
  EXPECT_TRUE(publisher.wait_applied(20s));
}

}  // namespace
}  // namespace collided
