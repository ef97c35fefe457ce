// Clearance of groups, and objects thought elsewhere, through the library and a real server.
#include <atomic>
#include <cmath>
#include <thread>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerGroups : public testing_support::ServerTest {
 protected:
  static void add(Client& client, const std::string& name, const Vec3& place, const ObjectOptions& like = {}) {
    ObjectOptions object = like;
    object.name = name;
    if (object.shape.empty()) object.shape = {BoxShape{.half_m = {0.5, 0.5, 0.5}}};
    object.pose.position = place;
    const Result<Added> added = client.add(object);
    ASSERT_TRUE(added) << added.error().message;
  }
  static ClearanceAnswer clearance(Client& client, const std::string& from, const ClearanceOptions& options = {}) {
    Result<ClearanceAnswer> answer = client.clearance(from, options);
    EXPECT_TRUE(answer) << answer.error().message << " " << answer.error().hint;
    return answer ? *answer : ClearanceAnswer{};
  }
  static std::string refusal(Client& client, const std::string& from, const ClearanceOptions& options = {}) {
    const Result<ClearanceAnswer> answer = client.clearance(from, options);
    EXPECT_FALSE(answer);
    return answer ? std::string() : answer.error().message;
  }
};

// Unit cubes 100 m above the warehouse: gaps of 1, 2 and 4 m along x.
TEST_F(ServerGroups, TheNearestPairsComeFirstWithTheirPointsAndBounds) {
  start();
  Client client = connect();
  add(client, "robot/base", {0, 0, 100});
  add(client, "robot/hand", {2, 0, 100});
  add(client, "cell/wall", {5, 0, 100});
  add(client, "cell/post", {8, 0, 100});
  const ClearanceAnswer one = clearance(client, "robot/*", {.to = "cell/*"});
  EXPECT_EQ(one.verdict, Verdict::miss);
  EXPECT_TRUE(one.cut);
  EXPECT_EQ(one.from_count, 2u);
  EXPECT_EQ(one.to_count, 2u);
  ASSERT_EQ(one.pairs.size(), 1u);
  const ClearancePair& nearest = one.pairs[0];
  EXPECT_EQ(nearest.a, "robot/hand");
  EXPECT_EQ(nearest.b, "cell/wall");
  EXPECT_EQ(nearest.verdict, Verdict::miss);
  EXPECT_NEAR(nearest.clearance_m, 2, nearest.error_m);
  EXPECT_LT(nearest.error_m, 1e-12);
  EXPECT_NEAR(nearest.on_a.x(), 2.5, 1e-12);
  EXPECT_NEAR(nearest.on_b.x(), 4.5, 1e-12);
  EXPECT_NEAR((nearest.normal - Vec3(1, 0, 0)).norm(), 0, 1e-12);

  const ClearanceAnswer near = clearance(client, "robot/*", {.to = "cell/*", .most = 100, .nearer_m = 4.5});
  EXPECT_FALSE(near.cut);
  ASSERT_EQ(near.pairs.size(), 2u);
  EXPECT_NEAR(near.pairs[1].clearance_m, 4, near.pairs[1].error_m);
  EXPECT_EQ(clearance(client, "robot/*", {.to = "cell/*", .nearer_m = 1.5}).pairs.size(), 0u);
  // A group against itself: each pair once, and no object with itself.
  const ClearanceAnswer own = clearance(client, "robot/*", {.to = "robot/*", .most = 100});
  ASSERT_EQ(own.pairs.size(), 1u);
  EXPECT_NEAR(own.pairs[0].clearance_m, 1, own.pairs[0].error_m);
  // Without another group it is everything else, the warehouse too.
  const ClearanceAnswer rest = clearance(client, "robot/*", {.most = 1'000});
  EXPECT_GT(rest.to_count, 20u);
  EXPECT_EQ(rest.pairs.size(), rest.from_count * rest.to_count);
  // A scene by its name is all that was loaded with it.
  EXPECT_EQ(clearance(client, "robot/hand", {.to = "warehouse"}).to_count, rest.to_count - 2);
}

TEST_F(ServerGroups, WhatTouchesHasItsDepthAndEachPairIsProved) {
  start();
  Client client = connect();
  add(client, "a", {0, 0, 100});
  add(client, "b", {0.75, 0, 100});
  add(client, "c", {0, 3, 100});
  add(client, "d", {0, 3, 100}, {.shape = {SphereShape{.radius_m = 0.1}}});
  const ClearanceAnswer all = clearance(client, "[abcd]", {.to = "[abcd]", .most = 10, .certificate = true});
  EXPECT_EQ(all.verdict, Verdict::hit);
  ASSERT_EQ(all.pairs.size(), 6u);
  for (std::size_t i = 0; i < all.pairs.size(); ++i) {
    const ClearancePair& pair = all.pairs[i];
    EXPECT_TRUE(i == 0 || all.pairs[i - 1].clearance_m <= pair.clearance_m);
    ASSERT_TRUE(pair.certificate) << pair.a << ' ' << pair.b << ": " << pair.no_certificate;
    EXPECT_EQ(pair.certificate->touches, pair.verdict == Verdict::hit);
    EXPECT_TRUE(proves(*pair.certificate)) << pair.a << ' ' << pair.b;
  }
  // A ball within a box of half a metre: 0.5 m to the face, and its radius.
  EXPECT_NEAR(all.pairs[0].clearance_m, -0.6, all.pairs[0].error_m + 1e-12);
  EXPECT_NEAR(all.pairs[1].clearance_m, -0.25, all.pairs[1].error_m + 1e-12);
  EXPECT_EQ(clearance(client, "[abcd]", {.to = "[abcd]", .most = 10, .nearer_m = 0}).pairs.size(), 2u);
  // What groups and masks let pass through each other is left out, and counted.
  add(client, "e", {0, 3, 100}, {.group = 7});
  add(client, "f", {0, 3, 100}, {.group = 7});
  EXPECT_EQ(clearance(client, "e", {.to = "f"}).pairs.size(), 0u);
  EXPECT_EQ(clearance(client, "e", {.to = "f"}).filtered, 1u);
  EXPECT_EQ(clearance(client, "e", {.to = "f", .with_filtered = true}).verdict, Verdict::hit);
}

TEST_F(ServerGroups, WhatCannotBeAskedIsRefusedWithTheReason) {
  start();
  Client client = connect();
  add(client, "robot/hand", {0, 0, 100});
  EXPECT_EQ(refusal(client, "robot/hnd"),
            "server refused: clearance: object 'robot/hnd' is not in the world (32 objects); nearest names: "
            "robot/hand; scenes: "
            "warehouse");
  EXPECT_EQ(refusal(client, "robt/*", {.to = "warehouse"}),
            "server refused: clearance: no object's name matches 'robt/*' (32 objects)");
  EXPECT_EQ(refusal(client, "robot/hand", {.to = "robot/*"}),
            "server refused: clearance: both groups are 'robot/hand' alone");
  EXPECT_EQ(refusal(client, "robot/*", {.skip = "*"}),
            "server refused: clearance: all of 'robot/*' is left out by skip '*'");
  EXPECT_EQ(refusal(client, "*"), "server refused: clearance: beside '*' nothing is in the world");
  EXPECT_EQ(refusal(client, "robot/*", {.most = 0}), "server refused: clearance: 'most' is 0; allowed 1 and more");
  EXPECT_NE(refusal(client, "robot/*", {.most = 10'001}).find("a whole number from 0 to 10000"), std::string::npos);
  EXPECT_EQ(refusal(client, "robot/*", {.nearer_m = std::nan("")}), "clearance: nearer_m is nan; allowed 0 or more");
}

TEST_F(ServerGroups, ADeadlineEndsItUndecided) {
  start();
  Client client = connect();
  add(client, "robot/hand", {0, 0, 100});
  const ClearanceAnswer late = clearance(client, "*", {.to = "*", .most = 1'000, .deadline = 1ns});
  EXPECT_TRUE(late.late);
  EXPECT_EQ(late.verdict, Verdict::undecided);
  EXPECT_EQ(late.reason, UndecidedReason::deadline);
}

class ServerWhatIf : public ServerGroups {
 protected:
  static Result<WhatIfAnswers> ask(Client& client, const std::vector<std::string>& objects, std::vector<Pose> poses,
                                   const WhatIfOptions& options = {}) {
    return client.what_if({.objects = objects, .poses = std::move(poses)}, options);
  }
  static std::string why_not(Client& client, const std::vector<std::string>& objects, std::vector<Pose> poses,
                             const WhatIfOptions& options = {}) {
    const Result<WhatIfAnswers> answer = ask(client, objects, std::move(poses), options);
    EXPECT_FALSE(answer);
    return answer ? std::string() : answer.error().message;
  }
};

// Unit cubes 100 m up, the wall's near face at x = 4.5: the hand is free up to x = 4.
TEST_F(ServerWhatIf, EachConfigurationIsAnsweredForItselfAndTheWorldStays) {
  start();
  Client client = connect();
  add(client, "hand", {0, 0, 100});
  add(client, "wall", {5, 0, 100});
  const std::uint64_t before = clearance(client, "hand", {.to = "wall"}).version;
  const std::vector<Pose> poses{at(0, 0, 100), at(3.75, 0, 100), at(4.25, 0, 100), at(5, 0, 100), at(3, 0, 100)};
  const Result<WhatIfAnswers> quick = ask(client, {"hand"}, poses);
  ASSERT_TRUE(quick) << quick.error().message;
  ASSERT_EQ(quick->configurations.size(), 5u);
  const Verdict expected[] = {Verdict::miss, Verdict::miss, Verdict::hit, Verdict::hit, Verdict::miss};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(quick->configurations[i].verdict, expected[i]) << i;
  ASSERT_TRUE(quick->configurations[2].nearest);
  EXPECT_EQ(quick->configurations[2].nearest->a, "hand");
  EXPECT_EQ(quick->configurations[2].nearest->b, "wall");
  const Result<WhatIfAnswers> full = ask(client, {"hand"}, poses, {.against = "wall", .with_clearance = true});
  ASSERT_TRUE(full) << full.error().message;
  const double clearance_m[] = {4, 0.25, -0.25, -1, 1};
  for (std::size_t i = 0; i < 5; ++i) {
    const ConfigurationAnswer& answer = full->configurations[i];
    EXPECT_EQ(answer.verdict, expected[i]) << i;
    ASSERT_TRUE(answer.nearest) << i;
    EXPECT_NEAR(answer.nearest->clearance_m, clearance_m[i], answer.nearest->error_m + 1e-12) << i;
    EXPECT_LT(answer.nearest->error_m, 1e-9);
  }
  EXPECT_NEAR(full->configurations[1].nearest->on_a.x(), 4.25, 1e-12);
  EXPECT_NEAR(full->configurations[1].nearest->on_b.x(), 4.5, 1e-12);
  // Farther than asked for: free, without a pair.
  const Result<WhatIfAnswers> near =
      ask(client, {"hand"}, poses, {.against = "wall", .with_clearance = true, .nearer_m = 0.5});
  ASSERT_TRUE(near);
  EXPECT_FALSE(near->configurations[0].nearest);
  EXPECT_TRUE(near->configurations[1].nearest);
  const ClearanceAnswer after = clearance(client, "hand", {.to = "wall"});
  EXPECT_EQ(after.version, before);
  EXPECT_NEAR(after.pairs.at(0).clearance_m, 4, 1e-9);
}

// 20,000 configurations of three objects travel in 61 messages and are answered on one state, in their order.
TEST_F(ServerWhatIf, ManyConfigurationsAreOneRequestOnOneState) {
  start();
  Client client = connect();
  for (const char* name : {"a", "b", "c"}) add(client, name, {0, 0, 100}, {.group = 3});
  add(client, "wall", {5, 0, 100});
  std::vector<Pose> poses;
  for (int i = 0; i < 20'000; ++i) {
    const double x = 5.0 * (i % 1'000) / 1'000;
    poses.insert(poses.end(), {at(-5, 0, 100), at(x, 0, 100), at(-8, 0, 100)});
  }
  std::atomic<bool> done{false};
  std::thread other([&] {
    Client mover = connect();
    while (!done.load()) ASSERT_TRUE(mover.move("wall", at(5, 0, 100), true));
  });
  const Result<WhatIfAnswers> answers = ask(client, {"a", "b", "c"}, poses, {.against = "wall"});
  done.store(true);
  other.join();
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->configurations.size(), 20'000u);
  for (std::size_t i = 0; i < 20'000; ++i) {
    const bool touches = 5.0 * static_cast<double>(i % 1'000) / 1'000 >= 4;
    ASSERT_EQ(answers->configurations[i].verdict, touches ? Verdict::hit : Verdict::miss) << i;
    if (touches) { ASSERT_EQ(answers->configurations[i].nearest->a, "b"); }
  }
}

TEST_F(ServerWhatIf, WhatIsAttachedMovesAlong) {
  start();
  Client client = connect();
  add(client, "hand", {0, 0, 100});
  add(client, "crate", {0, 0, 102});
  add(client, "label", {0, 2, 102});
  add(client, "wall", {5, 0, 102});
  EXPECT_EQ(ask(client, {"hand"}, {at(5, 0, 100)}, {.against = "wall"})->configurations[0].verdict, Verdict::miss);
  const Result<WhatIfAnswers> held = ask(client, {"hand"}, {at(5, 0, 100), at(5, -2, 100), at(0, 0, 100)},
                                         {.against = "wall", .attached = {{"label", "crate"}, {"crate", "hand"}}});
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_EQ(held->configurations[0].nearest->a, "crate");
  EXPECT_EQ(held->configurations[1].nearest->a, "label");
  EXPECT_EQ(held->configurations[2].verdict, Verdict::miss);
  EXPECT_EQ(why_not(client, {"hand"}, {at(0, 0, 0)}, {.attached = {{"crate", "wall"}}}),
            "server refused: what-if: 'crate' is attached to 'wall', which goes nowhere in this question");
}

TEST_F(ServerWhatIf, WhatCannotBeAskedIsRefusedWithTheReason) {
  start();
  Client client = connect();
  add(client, "hand", {0, 0, 100});
  EXPECT_EQ(why_not(client, {"hnd"}, {at(0, 0, 0)}),
            "server refused: what-if: object 'hnd' is not in the world (32 objects); nearest names: hand");
  EXPECT_EQ(why_not(client, {"hand", "hand"}, {at(0, 0, 0), at(0, 0, 0)}),
            "server refused: what-if: object 'hand' is named twice");
  EXPECT_EQ(why_not(client, {"warehouse/floor"}, {at(0, 0, 0)}),
            "server refused: what-if: object 'warehouse/floor' is a part of scene 'warehouse' and stays where it is");
  EXPECT_EQ(why_not(client, {"hand"}, {at(0, 0, 0)}, {.against = "hand"}),
            "server refused: what-if: there is nothing that the object could touch");
  EXPECT_NE(why_not(client, {"hand"}, {at(0, 0, 0), {.position = {0, 0, 0}, .rotation = Quat(1, 1, 0, 0)}})
                .find("configuration 1, object 'hand': rotation 1 1 0 0 has norm"),
            std::string::npos);
  EXPECT_NE(why_not(client, {"hand", "x"}, {at(0, 0, 0)}).find("1 poses for 2 objects"), std::string::npos);
  const Result<WhatIfAnswers> late = ask(client, {"hand"}, std::vector<Pose>(5'000, at(0, 0, 1)), {.deadline = 1ns});
  ASSERT_TRUE(late) << late.error().message;
  EXPECT_EQ(late->configurations.back().verdict, Verdict::undecided);
  EXPECT_EQ(late->configurations.back().reason, UndecidedReason::deadline);
}

}  // namespace
}  // namespace collided
