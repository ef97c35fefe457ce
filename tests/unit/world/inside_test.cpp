// Declared solids in a world: what holds a point, and what a ball or box in a solid meets.
#include <cmath>

#include "server/world/query/pair_report.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"
#include "tests/unit/world/solid_world.hpp"

namespace collided::engine {
namespace {

using WorldInside = SolidWorld;

TEST_F(WorldInside, ABallWithinAClosedMeshIsAHitWhereTheMeshIsSolidAndAMissWhereItIsASurface) {
  load("surface", scenes::box({1, 1, 1}), "");
  EXPECT_EQ(ask(QuestionKind::sphere, {0.5, 0, 0, 0.1}).answers[0], Verdict::miss);
  EXPECT_EQ(ask(QuestionKind::box, {0.5, 0, 0, 0.1, 0.1, 0.1, 1, 0, 0, 0}).answers[0], Verdict::miss);
  EXPECT_EQ(inside({0.5, 0, 0}).answers[0], Verdict::miss);
  world_.remove_scene("surface");
  load("solid", scenes::box({1, 1, 1}), "*");
  EXPECT_EQ(ask(QuestionKind::sphere, {0.5, 0, 0, 0.1}).answers[0], Verdict::hit);
  expect_first(0.6);  // half a metre to the face, and the radius
  EXPECT_EQ(answers_.hits[0].normal, Vec3(-1, 0, 0)) << "from the ball to what it has to leave";
  EXPECT_EQ(ask(QuestionKind::box, {0.5, 0, 0, 0.1, 0.1, 0.1, 1, 0, 0, 0}).answers[0], Verdict::hit);
  expect_first(0.6);
  EXPECT_EQ(ask(QuestionKind::sphere, {0.5, 0, 0, 0.1}, HitMode::any).answers[0], Verdict::hit);
  EXPECT_EQ(ask(QuestionKind::box, {0.5, 0, 0, 0.1, 0.1, 0.1, 1, 0, 0, 0}, HitMode::any).answers[0], Verdict::hit);
  EXPECT_EQ(ask(QuestionKind::sphere, {1.2, 0, 0, 0.1}).answers[0], Verdict::miss);
  // The ball's centre decides what its depth is: out it is that of the surface.
  ask(QuestionKind::sphere, {1.05, 0, 0, 0.1});
  expect_first(0.05);
  ask(QuestionKind::sphere, {0.95, 0, 0, 0.1});
  expect_first(0.15);
}

// Its slot went to the next object, and the triangles answered under that one's name.
TEST_F(WorldInside, WhatWasTakenOutOfASceneStaysOutWhenOthersCome) {
  load("surface", scenes::box({1, 1, 1}), "");
  const std::vector<double> ray{5, 0, 0, -1, 0, 0, INFINITY};
  ASSERT_EQ(ask(QuestionKind::ray, ray).answers[0], Verdict::hit);
  ASSERT_TRUE(world_.remove(*world_.find("surface"), EndReason::removed));
  step();
  add("ball", Sphere{Vec3::Zero(), 1}, Vec3(0, 9, 0));
  EXPECT_EQ(ask(QuestionKind::ray, ray).answers[0], Verdict::miss);
  // Without the scene its slots are free again.
  world_.remove_scene("surface");
  step();
  add("next", Sphere{Vec3::Zero(), 1}, Vec3(0, 99, 0));
  EXPECT_LT(slot_of(*world_.find("next")), slot_of(*world_.find("ball")));
}

/// How far two boxes overlap along the axis along which that is least: the shortest way apart of two polytopes that
/// overlap ends where two faces or two edges meet (Gottschalk, Lin, Manocha, "OBBTree", 1996).
double way_apart_m(const Box& a, const Box& b) {
  std::vector<Vec3> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.axes.col(i));
    axes.push_back(b.axes.col(i));
    for (int k = 0; k < 3; ++k) axes.push_back(a.axes.col(i).cross(b.axes.col(k)));
  }
  double least_m = INFINITY;
  for (const Vec3& axis : axes) {
    if (axis.norm() < 1e-6) continue;
    const Vec3 n = axis.normalized();
    const double reach_m =
        (a.axes.transpose() * n).cwiseAbs().dot(a.half_m) + (b.axes.transpose() * n).cwiseAbs().dot(b.half_m);
    least_m = std::min(least_m, reach_m - std::abs((b.center - a.center).dot(n)));
  }
  return least_m;
}

TEST_F(WorldInside, ABoxThatLiesInASolidHasADepthWithABoundThatHolds) {
  std::mt19937_64 random = oracle::seeded(170);
  std::uniform_real_distribution<double> in(-1, 1);
  std::normal_distribution<double> any;
  const auto turn = [&]() -> Quat { return Quat(any(random), any(random), any(random), any(random)).normalized(); };
  const Vec3 half{1, 1.5, 2};
  const Pose pose{.position = {5, -3, 2}, .rotation = turn()};
  add("crate", scenes::box(half), pose);
  const Box solid = place(frame_of(pose), Box{.center = Vec3::Zero(), .half_m = half});
  int hits = 0;
  double worst_share = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 center = pose.position + pose.rotation * Vec3(0.6 * in(random), in(random), 1.5 * in(random));
    // Along the solid's own axes the bound is tight; turned, the box's bounds are wider than it.
    const Quat q = i % 2 == 0 ? pose.rotation : turn();
    const Vec3 own = 0.1 * Vec3(1.2 + in(random), 1.2 + in(random), 1.2 + in(random));
    ask(QuestionKind::box, {center.x(), center.y(), center.z(), own.x(), own.y(), own.z(), q.w(), q.x(), q.y(), q.z()});
    ASSERT_EQ(answers_.hits.size(), 1u);
    const AnswerHit& hit = answers_.hits[0];
    const Box asked{.center = center, .axes = frame_of({.position = center, .rotation = q}).rotation, .half_m = own};
    const double truth_m = way_apart_m(solid, asked);
    const bool is_wholly_in = truth_m > 2 * own.norm();
    if (!is_wholly_in) continue;
    ++hits;
    ASSERT_LE(hit.distance_m, truth_m + 1e-12);
    ASSERT_GE(hit.distance_m + hit.error_m, truth_m - 1e-12);
    worst_share = std::max(worst_share, hit.error_m / own.norm());
  }
  EXPECT_GT(hits, 200);
  EXPECT_LT(worst_share, 3);
}

TEST_F(WorldInside, APairSaysHowDeepOneLiesInTheOther) {
  add("cube", scenes::box({1, 1, 1}), {});
  add("ball", Sphere{Vec3::Zero(), 0.25}, {0.5, 0, 0});
  add("shell", scenes::box({1, 1, 1}), {.position = {10, 0, 0}}, false);
  add("other", Sphere{Vec3::Zero(), 0.25}, {10, 0, 0});
  const auto lease = world_.newest();
  const auto pair = [&](const char* a, const char* b) {
    return report_pair(*lease, *world_.find(a), *world_.find(b), {});
  };
  const PairReport in = pair("ball", "cube");
  EXPECT_EQ(in.touches, Decision::no) << "their surfaces are apart";
  EXPECT_EQ(in.contained, Contained::a_in_b);
  ASSERT_TRUE(in.within.has_value());
  EXPECT_NEAR(in.within->depth_m, 0.75, in.within->depth_error_m);
  EXPECT_LT(in.within->depth_error_m, 1e-12);
  EXPECT_EQ(in.within->normal, Vec3(-1, 0, 0)) << "the cube moves that way";
  EXPECT_EQ(pair("cube", "ball").within->normal, Vec3(1, 0, 0));
  EXPECT_EQ(pair("other", "shell").contained, Contained::a_in_b);
  EXPECT_FALSE(pair("other", "shell").within) << "a surface that nobody declared solid has no depth";
}

TEST_F(WorldInside, DepthIsThatOfThePoint) {
  load("cube", scenes::box({1, 1, 1}), "cube");
  inside({0.25, 0, 0});
  EXPECT_EQ(names(), "cube");
  expect_first(0.75);
  EXPECT_EQ(answers_.hits[0].flags, kHitInside);
  EXPECT_EQ(answers_.hits[0].point, Vec3(1, 0, 0));
  inside({1, 0.5, 0.5});
  EXPECT_EQ(answers_.answers[0], Verdict::hit) << "the surface belongs to the solid";
  EXPECT_EQ(answers_.hits[0].distance_m, 0);
  EXPECT_EQ(answers_.hits[0].error_m, 0);
  EXPECT_EQ(inside({std::nextafter(1.0, 2.0), 0.5, 0.5}).answers[0], Verdict::miss);
  EXPECT_EQ(inside({0, 0, 0}, HitMode::any).answers[0], Verdict::hit);
  EXPECT_EQ(inside({NAN, 0, 0}).answers[0], Verdict::invalid);
}

TEST_F(WorldInside, EveryKindOfSolidIsAskedDeepestFirst) {
  load("cube", scenes::box({1, 1, 1}), "cube");
  add("ball", Sphere{.center = Vec3::Zero(), .radius_m = 3}, {0, 0, 0});
  add("turned", scenes::box({2, 2, 2}), {.position = {0.1, 0, 0}, .rotation = Quat(0.6, 0, 0, 0.8)});
  add("ground", HalfSpace{.point = Vec3::Zero(), .normal = {0, 0, 1}}, {0, 0, 0.5}, false);
  add("shell", scenes::box({5, 5, 5}), {}, false);
  inside({0, 0, 0});
  EXPECT_EQ(names(), "ball turned cube ground");
  EXPECT_EQ(ask(QuestionKind::inside, {0, 0, 0}, HitMode::closest, 2).reasons[0], UndecidedReason::truncated);
  inside({0, 0, 2.5});
  EXPECT_EQ(names(), "ball");
  inside({0, 0, -50});
  EXPECT_EQ(names(), "ground");
  expect_first(50.5);
}

TEST_F(WorldInside, NearIsZeroInASolidAndSignedMinusTheDepth) {
  load("cube", scenes::box({1, 1, 1}), "*");
  add("ball", Sphere{.center = Vec3::Zero(), .radius_m = 1}, {0, 0, 5});
  ask(QuestionKind::near, {0.25, 0, 0, INFINITY}, HitMode::closest, 1);
  expect_first(0);
  EXPECT_EQ(answers_.hits[0].flags, kHitInside);
  ask(QuestionKind::near, {0.25, 0, 0, INFINITY}, HitMode::signed_near, 1);
  expect_first(-0.75);
  EXPECT_EQ(names(), "cube");
  ask(QuestionKind::near, {2, 0, 0, INFINITY}, HitMode::signed_near, 1);
  expect_first(1);
  ask(QuestionKind::near, {0, 0, 4.5, INFINITY}, HitMode::signed_near, 2);
  EXPECT_EQ(names(), "ball cube");
  expect_first(-0.5);
}

// Where it does not close it stays a surface, and the others are solid all the same.
TEST_F(WorldInside, WhatDoesNotCloseIsRefusedAndStaysASurface) {
  TriangleMesh open = scenes::box({1, 1, 1});
  open.triangles.pop_back();
  const DeclaredSolids declared = load("open", open, "*");
  ASSERT_EQ(declared.refused.size(), 1u);
  EXPECT_NE(declared.refused[0].find("open is not solid, and stays a surface: it does not close"), std::string::npos)
      << declared.refused[0];
  EXPECT_EQ(declared.count, 0u);
  EXPECT_EQ(inside({0, 0, 0}).answers[0], Verdict::miss);
  EXPECT_EQ(load("other", scenes::box({1, 1, 1}), "nothing*").count, 0u);
}

TEST_F(WorldInside, WhereTrianglesCrossDepthsAreLowerBounds) {
  TriangleMesh two = scenes::box({1, 1, 1});
  scenes::append(two, scenes::box({1, 1, 1}, {1, 0.5, 0.25}));
  const DeclaredSolids declared = load("two", two, "*");
  EXPECT_EQ(declared.warnings.size(), 1u);
  inside({0.9, 0.1, 0});
  EXPECT_EQ(names(), "two");
  EXPECT_EQ(answers_.hits[0].error_m, INFINITY);
}

TEST_F(WorldInside, OutsideOfWhatIsCoveredAMissIsUndecided) {
  load("cube", scenes::box({1, 1, 1}), "*");
  const Aabb covered{{-2, -2, -2}, {2, 2, 2}};
  world_.state_covers("", std::span(&covered, 1));
  step();
  EXPECT_EQ(inside({1.5, 0, 0}).answers[0], Verdict::miss);
  EXPECT_EQ(inside({3, 0, 0}).reasons[0], UndecidedReason::not_covered);
  EXPECT_EQ(inside({0, 0, 0}).answers[0], Verdict::hit);
}

// Random points about moving and resting solids against rationals without an index; the audit asks its own.
TEST_F(WorldInside, RandomPointsAreDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(27);
  const TriangleMesh rough = scenes::rough_sphere(2, random);
  const Pose pose{.position = {0.3, 0.2, 0.1}, .rotation = Quat(0.5, 0.5, -0.5, 0.5)};
  load("resting", rough, "*");
  add("placed", rough, pose);
  const oracle::SolidOracle oracle(rough);
  std::uniform_real_distribution<double> any(-1.5, 1.5);
  int in = 0;
  for (int i = 0; i < 300; ++i) {
    Vec3 p(any(random), any(random), any(random));
    if (i % 3 == 0) p = rough.vertices[random() % rough.vertices.size()];
    std::set<std::string> expected;
    if (oracle.side(oracle::rational(p), random) != SolidSide::out) expected.insert("resting");
    if (oracle.side(oracle::seen_from(pose, p), random) != SolidSide::out) expected.insert("placed");
    inside(p);
    std::set<std::string> found;
    for (const AnswerHit& hit : answers_.hits) found.insert(lease_->objects[slot_of(hit.object)]->name);
    ASSERT_EQ(found, expected) << p.transpose();
    in += static_cast<int>(found.size());
    // A ball reaches as far as its radius and its centre's side say.
    ask(QuestionKind::sphere, {p.x(), p.y(), p.z(), 0.05});
    for (const std::string& name : expected) EXPECT_NE(names().find(name), std::string::npos);
  }
  EXPECT_GT(in, 50);
}

}  // namespace
}  // namespace collided::engine
