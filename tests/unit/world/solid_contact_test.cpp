// Declared solids in the collision step: what lies in one is in contact with it, wholly within or not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

Quat any_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> any;
  return Quat(any(random), any(random), any(random), any(random)).normalized();
}

/// A pair as the events have it, and whether they came in the order that they promise.
struct PairStory {
  bool is_held = false;
  Contained contained = Contained::none;
  std::string told;  // the kinds' first letters: b, e, c, x for emerged, p
};

class SolidContact : public testing::Test {
 protected:
  ObjectId add(const std::string& name, Shape shape, const Pose& pose, bool is_solid = false, bool moving = true,
               std::uint64_t publisher = 0) {
    ObjectDefinition definition;
    definition.name = name;
    definition.pose = pose;
    definition.moving = moving;
    definition.publisher = publisher;
    definition.shape = std::move(shape);
    if (definition.shape.mesh) {
      const TriangleMesh& mesh = *definition.shape.mesh;
      definition.indexed =
          indexed_mesh(definition.shape.mesh, Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
      SolidFindings findings;
      if (is_solid) definition.solid = solid_within(definition.indexed, findings);
      EXPECT_EQ(definition.solid != nullptr, is_solid) << findings.refusal;
    }
    const auto made = world_.define(definition);
    EXPECT_TRUE(std::holds_alternative<ObjectId>(made));
    return std::get<ObjectId>(made);
  }
  static Shape mesh_of(const TriangleMesh& mesh) { return {{}, std::make_shared<const TriangleMesh>(mesh)}; }
  static Shape ball(double radius_m) { return {{Sphere{Vec3::Zero(), radius_m}}, nullptr}; }
  static Pose at(double x, double y = 0, double z = 0) { return {.position = {x, y, z}}; }

  void load(const std::string& name, const TriangleMesh& mesh, const std::string& solid) {
    Scene scene;
    scene.name = name;
    scene.mesh = mesh;
    scene.parts = {{.name = name,
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(mesh.triangles.size()),
                    .filter = {}}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    if (!solid.empty()) declare_solids(indexed.scene, *indexed.geometry, solid);
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed)));
  }

  void step(bool persisted = false) {
    ASSERT_TRUE(world_.step(time_ns_ += 10 * kMillisecond, 1, {.contacts = true, .persisted = persisted}));
    for (const Event& event : world_.events()) hear(event);
    for (const OpenContact& open : world_.contacts()) {
      PairStory& pair = pairs_[{open.a, open.b}];
      EXPECT_TRUE(pair.is_held);
      EXPECT_EQ(open.contained, pair.contained);
    }
  }
  void move(ObjectId id, const Pose& pose) { EXPECT_TRUE(world_.move(id, pose, time_ns_ + 5 * kMillisecond, false)); }
  PairStory& of(ObjectId a, ObjectId b) { return pairs_[{std::min(a, b), std::max(a, b)}]; }
  /// Which of the two the events say lies within the other; 0: neither.
  ObjectId inner(ObjectId a, ObjectId b) {
    const Contained which = of(a, b).contained;
    if (which == Contained::none) return 0;
    return which == Contained::a_in_b ? std::min(a, b) : std::max(a, b);
  }
  const OpenContact& open(ObjectId a, ObjectId b) {
    const auto& all = world_.contacts();
    const auto found = std::find_if(all.begin(), all.end(), [&](const OpenContact& open) {
      return open.a == std::min(a, b) && open.b == std::max(a, b);
    });
    EXPECT_NE(found, all.end());
    return *found;
  }

  void hear(const Event& event) {
    EXPECT_GE(event.bracket_low_s, event.bracket_high_s);
    PairStory& pair = pairs_[{event.of.a, event.of.b}];
    pair.told += "bpecx"[static_cast<std::size_t>(event.kind)];
    if (event.kind == EventKind::began) {
      EXPECT_FALSE(pair.is_held);
      pair = {.is_held = true, .contained = Contained::none, .told = pair.told};
      episode_ = event.sequence;
      return;
    }
    EXPECT_TRUE(pair.is_held);
    if (event.kind == EventKind::contained) {
      EXPECT_EQ(pair.contained, Contained::none);
      pair.contained = event.of.contained;
    } else if (event.kind == EventKind::emerged) {
      EXPECT_EQ(pair.contained, event.of.contained);
      EXPECT_NE(pair.contained, Contained::none);
      pair.contained = Contained::none;
    } else if (event.kind == EventKind::ended) {
      EXPECT_EQ(pair.contained, Contained::none) << "it must emerge first";
      pair.is_held = false;
    }
  }

  World world_{WorldOptions{}};
  std::int64_t time_ns_ = 1'000'000 * kMillisecond;
  std::uint64_t episode_ = 0;
  std::map<std::pair<ObjectId, ObjectId>, PairStory> pairs_;
};

TEST_F(SolidContact, ABallThatPassesWhollyInStaysInContactAndEmergesBeforeItLeaves) {
  const ObjectId cube = add("cube", mesh_of(scenes::box({1, 1, 1})), at(0), true, false);
  const ObjectId thing = add("thing", ball(0.25), at(3));
  step();
  move(thing, at(1.1));
  step();
  EXPECT_EQ(of(cube, thing).told, "b");
  move(thing, at(0.5));
  step();
  EXPECT_EQ(of(cube, thing).told, "bc");
  EXPECT_EQ(inner(cube, thing), thing);
  // Half a metre to the nearest face, and its radius.
  EXPECT_NEAR(open(cube, thing).contact.depth_m, 0.75, open(cube, thing).contact.depth_error_m);
  EXPECT_LT(open(cube, thing).contact.depth_error_m, 1e-12);
  const double outward = cube < thing ? 1 : -1;
  EXPECT_EQ(open(cube, thing).contact.normal, Vec3(outward, 0, 0));
  move(thing, at(0));
  step(true);
  EXPECT_EQ(of(cube, thing).told, "bcp");
  move(thing, at(-1));
  step();
  EXPECT_EQ(of(cube, thing).told, "bcpx");
  EXPECT_TRUE(of(cube, thing).is_held);
  move(thing, at(0));
  step();
  move(thing, at(3));
  step();
  EXPECT_EQ(of(cube, thing).told, "bcpxcxe");
}

TEST_F(SolidContact, ASurfaceIsLeftByWhatPassesWhollyIn) {
  const ObjectId cube = add("cube", mesh_of(scenes::box({1, 1, 1})), at(0), false, false);
  const ObjectId thing = add("thing", ball(0.25), at(1));
  step();
  move(thing, at(0));
  step();
  EXPECT_EQ(of(cube, thing).told, "be");
}

TEST_F(SolidContact, InOneStepItBeginsAndIsContained) {
  const ObjectId cube = add("cube", mesh_of(scenes::box({1, 1, 1})), at(0), true, false);
  const ObjectId thing = add("thing", ball(0.25), at(3));
  step();
  move(thing, at(0));
  step();
  EXPECT_EQ(of(cube, thing).told, "bc");
  move(thing, at(3));
  step();
  EXPECT_EQ(of(cube, thing).told, "bcxe");
  EXPECT_TRUE(world_.contacts().empty());
}

TEST_F(SolidContact, WhatBeginsInASolidPartOfASceneIsInContact) {
  load("hall", scenes::box({2, 2, 2}), "*");
  load("shell", scenes::box({2, 2, 2}, {10, 0, 0}), "");
  const ObjectId in_hall = add("in hall", ball(0.5), at(0));
  const ObjectId in_shell = add("in shell", ball(0.5), at(10));
  step();
  const ObjectId hall = *world_.find("hall");
  EXPECT_EQ(of(hall, in_hall).told, "bc");
  EXPECT_EQ(inner(hall, in_hall), in_hall);
  EXPECT_EQ(of(*world_.find("shell"), in_shell).told, "");
  move(in_hall, at(0.5));
  step();
  EXPECT_EQ(of(hall, in_hall).told, "bc");
}

TEST_F(SolidContact, AMovingSolidHoldsWhatItComesToLieAround) {
  load("stone", scenes::icosphere(1, 0.25), "");
  const ObjectId pin = add("pin", mesh_of(scenes::box({0.1, 0.1, 0.1}, {0, 1, 0})), at(0), false, false);
  const ObjectId hood = add("hood", mesh_of(scenes::box({2, 2, 2})), at(8), true);
  step();
  // By a jump over both, since on a way there it would touch them.
  ASSERT_TRUE(world_.move(hood, at(0), time_ns_ + 5 * kMillisecond, true));
  step();
  const ObjectId stone = *world_.find("stone");
  EXPECT_EQ(of(hood, stone).told, "bc");
  EXPECT_EQ(inner(hood, stone), stone);
  EXPECT_EQ(inner(hood, pin), pin);
  ASSERT_TRUE(world_.move(hood, at(8), time_ns_ + 5 * kMillisecond, true));
  step();
  EXPECT_EQ(of(hood, stone).told, "bcxe");
  EXPECT_EQ(of(hood, pin).told, "bcxe");
}

// Two balls, one in the cavity's wall and one outside: the surfaces share no point, and one of the two is in the solid.
TEST_F(SolidContact, WhatLiesInItInPartTouchesItAndIsNotContained) {
  const ObjectId cube = add("cube", mesh_of(scenes::box({1, 1, 1})), at(0), true, false);
  Shape pair;
  pair.primitives = {Sphere{{0, 0, 0}, 0.25}, Sphere{{3, 0, 0}, 0.25}};
  const ObjectId barbell = add("barbell", pair, at(0));
  step();
  EXPECT_EQ(of(cube, barbell).told, "b");
  move(barbell, at(-3));
  step();
  EXPECT_EQ(of(cube, barbell).told, "beb") << "the first ball was out before the other one came in";
  move(barbell, at(-6));
  step();
  EXPECT_FALSE(of(cube, barbell).is_held);
}

TEST_F(SolidContact, OneOfTheTwoIsRemovedOrLostWhileContained) {
  const ObjectId cube = add("cube", mesh_of(scenes::box({1, 1, 1})), at(0), true, false);
  const ObjectId lost = add("lost", ball(0.25), at(0), false, true, 7);
  const ObjectId gone = add("gone", ball(0.25), at(0.3), false, true);
  step();
  EXPECT_EQ(of(cube, lost).told, "bc");
  world_.set_stale(lost, true);
  world_.remove(gone, EndReason::removed);
  step();
  EXPECT_EQ(of(cube, gone).told, "bcxe");
  EXPECT_EQ(of(cube, lost).told, "bcxeb") << "a doubt says nothing of where it is";
}

// The surfaces are apart by less than a placed corner rounds: only the exact poses tell on which side it is.
TEST_F(SolidContact, FarOutARoundingDecidesRightWhetherItIsIn) {
  const double far_m = 1e9;
  const double turn = 0.3;
  const Quat rotation(std::cos(turn), 0, 0, std::sin(turn));
  const ObjectId cube =
      add("cube", mesh_of(scenes::box({1, 1, 1})), {.position = {far_m, 0, 0}, .rotation = rotation}, true, false);
  const ObjectId in = add("in", mesh_of(scenes::box({0.5, 0.5, 1e-9}, {0, 0, 1 - 2e-9})),
                          {.position = {far_m, 0, 0}, .rotation = rotation});
  const ObjectId out = add("out", mesh_of(scenes::box({0.5, 0.5, 1e-9}, {0, 0, 1 + 2e-9})),
                           {.position = {far_m, 0, 0}, .rotation = rotation});
  step();
  EXPECT_EQ(inner(cube, in), in);
  EXPECT_EQ(of(cube, out).told, "");
}

/// By brute force over all triangles and rationals for the side: how a ball stands to a solid at a pose.
struct BallState {
  bool touches = false;
  bool is_within = false;
  bool is_clear = true;  // not so near to a change that double could err
  double gap_m = 0;      // between ball and surface
};

class BallOracle {
 public:
  explicit BallOracle(TriangleMesh mesh) : mesh_(std::move(mesh)), sides_(mesh_) {}
  BallState state(const Pose& pose, const Vec3& center, double radius_m, std::mt19937_64& random) const {
    const Frame frame = frame_of(pose);
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i)
      nearest_m = std::min(nearest_m, closest(center, place(frame, mesh_.triangle(i))).distance_m);
    const bool meets = nearest_m <= radius_m;
    const bool is_in = sides_.side(oracle::seen_from(pose, center), random) != SolidSide::out;
    return {.touches = meets || is_in,
            .is_within = !meets && is_in,
            .is_clear = std::abs(nearest_m - radius_m) > 1e-9,
            .gap_m = nearest_m - radius_m};
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  oracle::SolidOracle sides_;
};

TEST_F(SolidContact, RandomMotionsInAndOutAgreeWithAnOracle) {
  std::mt19937_64 random = oracle::seeded(20261125);
  std::uniform_real_distribution<double> in(-1.6, 1.6);
  std::uniform_real_distribution<double> radius(0.02, 0.5);
  const BallOracle oracle(scenes::rough_sphere(2, random));
  const auto any_pose = [&] {
    return Pose{.position = {in(random), in(random), in(random)}, .rotation = any_rotation(random)};
  };
  load("rock", oracle.mesh(), "*");
  const Pose turned = any_pose();
  const ObjectId boulder = add("boulder", mesh_of(oracle.mesh()), turned, true);
  Pose boulder_pose = turned;
  std::vector<ObjectId> balls;
  std::vector<double> radii;
  std::vector<Vec3> centers;
  for (int i = 0; i < 12; ++i) {
    radii.push_back(radius(random));
    centers.push_back({in(random), in(random), in(random)});
    balls.push_back(add("ball" + std::to_string(i), ball(radii.back()), {.position = centers.back()}));
  }
  step();
  const ObjectId rock = *world_.find("rock");
  int checked = 0;
  int within = 0;
  for (int k = 0; k < 120; ++k) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      if (std::bernoulli_distribution(0.3)(random)) continue;
      centers[i] += 0.4 * Vec3(in(random), in(random), in(random));
      if (centers[i].norm() > 2) centers[i] /= centers[i].norm();
      move(balls[i], {.position = centers[i]});
    }
    if (k % 3 == 0) move(boulder, boulder_pose = any_pose());
    step(k % 2 == 0);
    for (std::size_t i = 0; i < balls.size(); ++i) {
      for (const auto& [solid, pose] : {std::pair(rock, Pose{}), std::pair(boulder, boulder_pose)}) {
        const BallState truth = oracle.state(pose, centers[i], radii[i], random);
        if (!truth.is_clear) continue;
        ASSERT_EQ(of(solid, balls[i]).is_held, truth.touches) << "step " << k << ", ball " << i;
        ASSERT_EQ(inner(solid, balls[i]), truth.is_within ? balls[i] : 0) << "step " << k << ", ball " << i;
        ++checked;
        within += truth.is_within ? 1 : 0;
      }
    }
  }
  EXPECT_GT(checked, 2000);
  EXPECT_GT(within, 100);
}

// Little meshes in a solid that turns: no corner is in a surface, so that all triangles and one corner of each decide.
TEST_F(SolidContact, RandomMeshesInAndOutAgreeWithAnOracle) {
  std::mt19937_64 random = oracle::seeded(20261126);
  std::uniform_real_distribution<double> in(-1.3, 1.3);
  const TriangleMesh shell = scenes::rough_sphere(1, random);
  const oracle::SolidOracle sides(shell);
  const TriangleMesh grain = scenes::icosphere(0, 0.15);
  const auto any_pose = [&] {
    return Pose{.position = {in(random), in(random), in(random)}, .rotation = any_rotation(random)};
  };
  Pose pose = any_pose();
  Pose other = any_pose();
  const ObjectId solid = add("solid", mesh_of(shell), pose, true);
  const ObjectId thing = add("grain", mesh_of(grain), other);
  step();
  int within = 0;
  for (int k = 0; k < 600; ++k) {
    if (k % 4 == 0) move(solid, pose = any_pose());
    other.position += 0.15 * Vec3(in(random), in(random), in(random));
    if (other.position.norm() > 2) other = any_pose();
    move(thing, other);
    step();
    const Frame frame = frame_of(pose);
    const Frame frame_of_grain = frame_of(other);
    bool meets = false;
    for (std::uint32_t i = 0; i < shell.triangles.size() && !meets; ++i) {
      for (std::uint32_t j = 0; j < grain.triangles.size() && !meets; ++j)
        meets = overlaps(place(frame, shell.triangle(i)), place(frame_of_grain, grain.triangle(j))).yes();
    }
    const bool is_in =
        sides.side(oracle::seen_from(pose, place(frame_of_grain, grain.vertices[0])), random) != SolidSide::out;
    ASSERT_EQ(of(solid, thing).is_held, meets || is_in) << "step " << k;
    ASSERT_EQ(inner(solid, thing), !meets && is_in ? thing : 0) << "step " << k;
    within += !meets && is_in ? 1 : 0;
  }
  EXPECT_GT(within, 15);
}

/// A straight way through its poses, each at an instant.
struct TimedWay {
  std::vector<std::int64_t> times_ns;
  std::vector<Vec3> places;

  Vec3 at(std::int64_t time_ns) const {
    std::size_t next = 1;
    while (next + 1 < times_ns.size() && times_ns[next] < time_ns) ++next;
    const double share =
        static_cast<double>(time_ns - times_ns[next - 1]) / static_cast<double>(times_ns[next] - times_ns[next - 1]);
    return places[next - 1] + std::clamp(share, 0.0, 1.0) * (places[next] - places[next - 1]);
  }
};

// Two publishers, each with instants of its own: what the events say of each instant is what the two motions say, and
// where the surfaces part or meet, the bracket has it.
TEST_F(SolidContact, SeveralPublishersAtOddInstantsAgreeWithAnOracle) {
  std::mt19937_64 random = oracle::seeded(20261127);
  std::uniform_real_distribution<double> in(-1.3, 1.3);
  const BallOracle oracle(scenes::rough_sphere(1, random));
  constexpr double kRadius_m = 0.2;
  TimedWay ways[2];
  ObjectId ids[2];
  for (std::size_t who = 0; who < 2; ++who) {
    std::int64_t time_ns = time_ns_;
    for (int i = 0; i < 150; ++i) {
      time_ns += std::uniform_int_distribution<std::int64_t>(3 * kMillisecond, 40 * kMillisecond)(random);
      ways[who].times_ns.push_back(time_ns);
      const double share = who == 0 ? 0.3 : 1;
      ways[who].places.push_back(share * Vec3(in(random), in(random), in(random)));
    }
    ids[who] = add(who == 0 ? "solid" : "ball", who == 0 ? mesh_of(oracle.mesh()) : ball(kRadius_m),
                   {.position = ways[who].places.front()}, who == 0, true, who + 1);
  }
  ASSERT_TRUE(world_.step(time_ns_, 1, {}));
  for (const Event& event : world_.events()) hear(event);
  struct Change {
    std::int64_t low_ns, high_ns;
    bool is_held, is_within;
  };
  const bool is_held_at_first = of(ids[0], ids[1]).is_held;
  const bool is_within_at_first = inner(ids[0], ids[1]) != 0;
  std::vector<Change> changes;
  std::size_t next[2] = {0, 0};
  std::int64_t now_ns = time_ns_;
  const auto take_step = [&] {
    ASSERT_TRUE(world_.step(++now_ns, 1, {}));
    for (const Event& event : world_.events()) {
      hear(event);
      const auto time = [&](double seconds_ago) { return now_ns - std::llround(seconds_ago * 1e9); };
      changes.push_back({time(event.bracket_low_s), time(event.bracket_high_s), of(ids[0], ids[1]).is_held,
                         of(ids[0], ids[1]).contained != Contained::none});
    }
  };
  while (next[0] < 150 || next[1] < 150) {
    std::size_t who = random() % 2;
    if (next[who] == 150) who = 1 - who;
    if (world_.has_moved(ids[who])) take_step();
    const std::int64_t time_ns = ways[who].times_ns[next[who]];
    world_.move(ids[who], {.position = ways[who].places[next[who]]}, time_ns, false);
    world_.advance(who + 1, time_ns);
    ++next[who];
    if (random() % 3 == 0) take_step();
  }
  take_step();
  const auto truth_at = [&](std::int64_t time_ns) {
    return oracle.state({.position = ways[0].at(time_ns)}, ways[1].at(time_ns), kRadius_m, random);
  };
  // At every instant of either, which is where the engine decides.
  const std::int64_t from_ns = std::max(ways[0].times_ns.front(), ways[1].times_ns.front());
  const std::int64_t to_ns = std::min(ways[0].times_ns.back(), ways[1].times_ns.back());
  int checked = 0;
  int within = 0;
  for (const TimedWay& way : ways) {
    for (const std::int64_t time_ns : way.times_ns) {
      if (time_ns < from_ns || time_ns > to_ns) continue;
      Change now{.low_ns = 0, .high_ns = 0, .is_held = is_held_at_first, .is_within = is_within_at_first};
      bool is_near_change = false;
      for (const Change& change : changes) {
        is_near_change = is_near_change || (change.low_ns <= time_ns && time_ns <= change.high_ns);
        if (change.high_ns <= time_ns) now = change;
      }
      const BallState truth = truth_at(time_ns);
      if (is_near_change || !truth.is_clear) continue;
      ASSERT_EQ(now.is_held, truth.touches) << time_ns - from_ns;
      ASSERT_EQ(now.is_within, truth.is_within) << time_ns - from_ns;
      ++checked;
      within += truth.is_within ? 1 : 0;
    }
  }
  EXPECT_GT(checked, 200);
  EXPECT_GT(within, 10);
  // Whatever changed, the surfaces just touched: the two close at less than 2,500 m/s, and a bracket is some nanoseconds.
  int exact = 0;
  for (const Change& change : changes) {
    if (change.high_ns <= from_ns || change.high_ns > to_ns) continue;
    EXPECT_LE(change.high_ns - change.low_ns, 100);
    EXPECT_NEAR(truth_at(change.high_ns).gap_m, 0, 2.5e-6 * static_cast<double>(change.high_ns - change.low_ns));
    ++exact;
  }
  EXPECT_GT(exact, 40);
}

}  // namespace
}  // namespace collided::engine
