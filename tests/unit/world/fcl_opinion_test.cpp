#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "server/geometry/convex_hull.hpp"
#include "server/intake/child_process.hpp"
#include "server/world/audit/fcl_opinion.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"

// FCL as an independent opinion: what is sent to it, what it says, and what comes of a program that breaks down.
namespace collided::engine {
namespace {

#ifdef COLLIDED_OPINION_BUILT
constexpr const char* kProgram = COLLIDED_OPINION_BUILT;
#else
constexpr const char* kProgram = "";
#endif

Shape of(Primitive primitive) { return {{std::move(primitive)}, nullptr}; }

/// One of each kind, within a ball of 0.9 m about its origin.
std::vector<std::pair<std::string, Shape>> every_shape() {
  const std::vector<Vec3> corners{{0.5, 0, 0},    {-0.5, 0.1, 0}, {0, 0.6, 0},
                                  {0, -0.5, 0.2}, {0, 0, 0.7},    {0.1, 0, -0.5}};
  return {{"sphere", of(Sphere{{0, 0, 0}, 0.5})},
          {"box", of(Box{.center = {0, 0, 0}, .half_m = {0.5, 0.4, 0.3}})},
          {"capsule", of(Capsule{{0, 0, -0.3}, {0.2, 0, 0.3}, 0.3})},
          {"cylinder", of(Cylinder{{0, -0.3, 0}, {0, 0.3, 0.2}, 0.4})},
          {"cone", of(Cone{{0, 0, 0.5}, {0, 0.1, -0.3}, 0.4})},
          {"ellipsoid", of(Ellipsoid{.center = {0, 0, 0}, .half_m = {0.6, 0.3, 0.4}})},
          {"hull", of(Hull{std::make_shared<const TriangleMesh>(*convex_hull(corners))})},
          {"mesh", {{}, std::make_shared<const TriangleMesh>(scenes::icosphere(2, 0.5))}}};
}

class FclOpinion : public testing::Test {
 protected:
  void SetUp() override { use(kProgram); }
  void TearDown() override {
    ::unsetenv("COLLIDED_OPINION_PROGRAM");
    std::filesystem::remove(script_path());
  }
  static void use(const std::string& program) { ::setenv("COLLIDED_OPINION_PROGRAM", program.c_str(), 1); }
  /// A stand-in for the program.
  static void use_script(const std::string& lines) {
    const std::string path = script_path();
    std::ofstream(path) << "#!/bin/sh\n" << lines << "\n";
    ASSERT_EQ(::system(("chmod +x " + path).c_str()), 0);
    use(path);
  }
  static std::string script_path() { return testing::TempDir() + "opinion_" + std::to_string(::getpid()) + ".sh"; }
  void fill(const Shape& a, const Shape& b, const Vec3& away) {
    const Quat turned = Quat(0.9, 0.3, -0.2, 0.1).normalized();
    a_ = std::get<ObjectId>(world_.define({.name = "a", .scene = {}, .shape = a, .pose = {}, .filter = {}}));
    b_ = std::get<ObjectId>(world_.define(
        {.name = "b", .scene = {}, .shape = b, .pose = {.position = away, .rotation = turned}, .filter = {}}));
    world_.step(++time_ns_, 1, {});
  }
  void clear() {
    world_.remove(a_, EndReason::removed);
    world_.remove(b_, EndReason::removed);
  }
  Opinion ask(const std::function<bool()>& cancelled = {}) {
    const SnapshotRing::Lease state = world_.newest();
    report_ = report_pair(*state, a_, b_, {});
    return fcl_opinion(*state, a_, b_, report_, cancelled);
  }
  void fill_two_balls() { fill(of(Sphere{{0, 0, 0}, 0.5}), of(Sphere{{0, 0, 0}, 0.5}), {2, 0, 0}); }

  World world_{WorldOptions{}};
  std::int64_t time_ns_ = 0;
  ObjectId a_ = 0;
  ObjectId b_ = 0;
  PairReport report_;
};

TEST_F(FclOpinion, EveryShapeAgrees) {
  if (!*kProgram) GTEST_SKIP() << "built without FCL";
  for (const auto& [a_name, a] : every_shape()) {
    for (const auto& [b_name, b] : every_shape()) {
      for (const Vec3& away : {Vec3(1.7, 0.4, 0.3), Vec3(0.45, 0.1, 0.2)}) {
        fill(a, b, away);
        const Opinion opinion = ask();
        EXPECT_EQ(opinion.verdict, OpinionVerdict::agree)
            << a_name << " and " << b_name << " at " << away.transpose() << ": FCL " << opinion.distance_m.value_or(-1)
            << ", ours " << report_.separation.distance_m << " " << opinion.why;
        EXPECT_EQ(opinion.distance_m.has_value(), report_.touches == Decision::no) << a_name << " and " << b_name;
        clear();
      }
    }
  }
}

TEST_F(FclOpinion, OfAHalfSpaceThereIsAYesOrNoWithoutADistance) {
  if (!*kProgram) GTEST_SKIP() << "built without FCL";
  const Shape ground = of(HalfSpace{{0, 0, 0}, {0, 0, 2}});
  for (const double height_m : {0.45, 3.0}) {
    ObjectDefinition floor{.name = "a", .scene = {}, .shape = ground, .pose = {}, .filter = {}};
    floor.moving = false;
    a_ = std::get<ObjectId>(world_.define(floor));
    b_ = std::get<ObjectId>(world_.define({.name = "b",
                                           .scene = {},
                                           .shape = of(Sphere{{0, 0, 0}, 0.5}),
                                           .pose = {.position = {0, 0, height_m}, .rotation = Quat::Identity()},
                                           .filter = {}}));
    world_.step(++time_ns_, 1, {});
    const Opinion opinion = ask();
    EXPECT_EQ(opinion.verdict, OpinionVerdict::agree) << opinion.why;
    EXPECT_EQ(opinion.touches, height_m < 0.5);
    EXPECT_FALSE(opinion.distance_m);
    clear();
  }
}

TEST_F(FclOpinion, AnotherNumberDiffersAndBothAreTold) {
  fill_two_balls();
  use_script("echo apart 1.5");
  Opinion opinion = ask();
  EXPECT_EQ(opinion.verdict, OpinionVerdict::differ);
  EXPECT_EQ(opinion.distance_m, 1.5);
  EXPECT_NEAR(report_.separation.distance_m, 1, 1e-12);
  use_script("echo touching");
  opinion = ask();
  EXPECT_EQ(opinion.verdict, OpinionVerdict::differ);
  EXPECT_EQ(opinion.touches, true);
  use_script("echo apart 1.0000000001");
  EXPECT_EQ(ask().verdict, OpinionVerdict::agree);
}

// FCL's asserts abort its process.
TEST_F(FclOpinion, AProgramThatBreaksDownHasFailed) {
  fill_two_balls();
  const auto why = [this] {
    const Opinion opinion = ask();
    EXPECT_EQ(opinion.verdict, OpinionVerdict::failed);
    EXPECT_FALSE(opinion.touches);
    return opinion.why;
  };
  use_script("echo 'gjk: Assertion failed.' >&2; kill -ABRT $$");
  EXPECT_EQ(why(), "FCL was ended by signal 6: gjk: Assertion failed.");
  use_script("echo no >&2; exit 3");
  EXPECT_EQ(why(), "collided-opinion failed with code 3: no");
  for (const char* nonsense :
       {"echo", "echo apart", "echo apart nan", "echo apart inf", "echo perhaps", "printf '\\377\\377'"}) {
    use_script(nonsense);
    EXPECT_EQ(why(), "collided-opinion printed no answer") << nonsense;
  }
  use("/nowhere/opinion");
  EXPECT_EQ(why(), "COLLIDED_OPINION_PROGRAM is '/nowhere/opinion', which is no program that can be run");
}

TEST_F(FclOpinion, WhoIsCalledOffDoesNotWait) {
  fill_two_balls();
  use_script("sleep 60");
  const Opinion opinion = ask([] { return true; });
  EXPECT_EQ(opinion.verdict, OpinionVerdict::failed);
  EXPECT_EQ(opinion.why, "called off");
}

TEST_F(FclOpinion, WhatFclHasNoAnswerForIsUnsupported) {
  fill_two_balls();
  use_script("echo unsupported two half-spaces");
  const Opinion opinion = ask();
  EXPECT_EQ(opinion.verdict, OpinionVerdict::unsupported);
  EXPECT_EQ(opinion.why, "two half-spaces");
}

// Shapes that are not FCL's own: a box whose axes are not square to each other.
TEST_F(FclOpinion, ASkewedBoxIsUnsupported) {
  if (!*kProgram) GTEST_SKIP() << "built without FCL";
  Mat3 skewed = Mat3::Identity();
  skewed(0, 1) = 0.5;
  const OpinionRequest request{{Primitive(Box{.center = {0, 0, 0}, .axes = skewed, .half_m = {1, 1, 1}})},
                               {Primitive(Sphere{{3, 0, 0}, 1})}};
  const Opinion opinion = ask_opinion_program(request, {});
  EXPECT_EQ(opinion.verdict, OpinionVerdict::unsupported);
  EXPECT_EQ(opinion.why, "axes that are not square to each other");
}

TEST_F(FclOpinion, AnUndecidedAnswerIsComparedWithNothing) {
  PairReport ours;
  ours.touches = Decision::undecided;
  const Opinion opinion = compared({.verdict = OpinionVerdict::failed, .touches = true}, ours, 1);
  EXPECT_EQ(opinion.verdict, OpinionVerdict::unsupported);
}

TEST_F(FclOpinion, TheProgramRefusesWhatIsNoRequest) {
  if (!*kProgram) GTEST_SKIP() << "built without FCL";
  const std::string nonsense = "opinion?";
  const ChildResult result = run_child({kProgram}, std::chrono::seconds(20), {}, std::as_bytes(std::span(nonsense)));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.errors, "the request for an opinion is none: it does not begin as one; nothing was asked\n");
  EXPECT_EQ(run_child({kProgram}, std::chrono::seconds(20), {}).exit_code, 2);
}

class OpinionRequestBytes : public testing::Test {
 protected:
  static std::vector<std::byte> good() {
    OpinionRequest request;
    for (const auto& [name, shape] : every_shape()) {
      for (const Primitive& primitive : shape.primitives) request.a.emplace_back(primitive);
    }
    request.a.emplace_back(Primitive(HalfSpace{{1, 2, 3}, {0, 0, 1}}));
    request.b.emplace_back(Triangle{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    return encoded(request);
  }
  static std::string refusal(const std::vector<std::byte>& bytes) {
    const auto read = read_opinion_request(bytes);
    return std::holds_alternative<std::string>(read) ? std::get<std::string>(read) : "it was taken";
  }
  template <class Number>
  static std::string refusal_with(std::size_t at, Number number) {
    std::vector<std::byte> bytes = good();
    std::memcpy(bytes.data() + at, &number, sizeof number);
    return refusal(bytes);
  }
  static constexpr std::size_t kFirstPart = 16;  // its kind; then a sphere's four numbers
};

TEST_F(OpinionRequestBytes, EveryKindComesBackAsItWas) {
  const std::vector<std::byte> bytes = good();
  const auto read = read_opinion_request(bytes);
  ASSERT_TRUE(std::holds_alternative<OpinionRequest>(read)) << std::get<std::string>(read);
  EXPECT_EQ(std::get<OpinionRequest>(read).a.size(), 8u);
  EXPECT_EQ(encoded(std::get<OpinionRequest>(read)), bytes);
}

TEST_F(OpinionRequestBytes, WhatBreaksOffOrGoesOnIsRefused) {
  std::vector<std::byte> bytes = good();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_NE(refusal({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), "it was taken") << size;
  }
  bytes.push_back(std::byte{0});
  EXPECT_NE(refusal(bytes).find("1 bytes are left over"), std::string::npos);
}

TEST_F(OpinionRequestBytes, NumbersThatMakeNoShapeAreRefused) {
  EXPECT_NE(refusal_with(kFirstPart + 1, std::nan("")).find("a number is nan"), std::string::npos);
  EXPECT_NE(refusal_with(kFirstPart + 25, -1.0).find("a size is -1"), std::string::npos);
  EXPECT_NE(refusal_with(kFirstPart, std::uint8_t{9}).find("kind 9, the last one is 8"), std::string::npos);
  EXPECT_NE(refusal_with(8, std::uint32_t{0}).find("0 and 1 parts"), std::string::npos);
  EXPECT_NE(refusal_with(8, std::uint32_t{200'000}).find("200000 and 1 parts"), std::string::npos);
  EXPECT_NE(refusal_with(0, std::uint64_t{1}).find("does not begin as one"), std::string::npos);
}

}  // namespace
}  // namespace collided::engine
