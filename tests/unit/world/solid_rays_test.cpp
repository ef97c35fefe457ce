// Rays and sweeps that begin in a declared solid, or a hair from the surface of what has a pose.
#include <gmpxx.h>

#include <cmath>
#include <random>

#include "server/exact_phase/exactly.hpp"
#include "server/geometry/mesh.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/oracle/solid_oracle.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/scenes/planted.hpp"
#include "tests/unit/world/solid_world.hpp"

namespace collided::engine {
namespace {

using WorldFromInside = SolidWorld;

std::vector<double> ray_numbers(const Vec3& from, const Vec3& along, double length_m = INFINITY) {
  return {from.x(), from.y(), from.z(), along.x(), along.y(), along.z(), length_m};
}

/// A small box, from one place to another without turning.
std::vector<double> straight_numbers(const Vec3& from, const Vec3& to) {
  return {from.x(), from.y(), from.z(), 1, 0, 0, 0, to.x(), to.y(), to.z(), 1, 0, 0, 0};
}

TEST_F(WorldFromInside, ARayThatBeginsInASolidSaysSoAndWhereItLeaves) {
  load("shell", scenes::box({1, 1, 1}), "");
  ask(QuestionKind::ray, ray_numbers({0.25, 0, 0}, {2, 0, 0}));
  expect_first(0.75);
  EXPECT_EQ(answers_.hits[0].flags, 0) << "a surface holds nothing";
  world_.remove_scene("shell");
  load("solid", scenes::box({1, 1, 1}), "*");
  for (const HitMode mode : {HitMode::closest, HitMode::any, HitMode::all}) {
    // The length ends before the way out.
    ask(QuestionKind::ray, ray_numbers({0.25, 0, 0}, {2, 0, 0}, 0.5), mode);
    ASSERT_EQ(answers_.hits.size(), 1u);
    const AnswerHit& hit = answers_.hits[0];
    EXPECT_EQ(hit.distance_m, 0);
    EXPECT_EQ(hit.error_m, 0);
    EXPECT_EQ(hit.flags, kHitInside);
    EXPECT_EQ(hit.triangle, kNoTriangle);
    EXPECT_NEAR(hit.exit_m, 0.75, 1e-15);
    EXPECT_EQ(hit.point, Vec3(0.25, 0, 0));
    EXPECT_EQ(hit.normal, Vec3(1, 0, 0)) << "outward, where it leaves";
  }
  ask(QuestionKind::ray, ray_numbers({0.25, 0, 0}, {2, 0, 0}), HitMode::all);
  EXPECT_GE(answers_.hits.size(), 2u) << "the surface is met as well";
  ask(QuestionKind::ray, ray_numbers({1, 0.25, 0.5}, {1, 0, 0}));
  EXPECT_EQ(answers_.hits[0].flags, 0) << "on the surface it has met a triangle";
  EXPECT_NE(answers_.hits[0].triangle, kNoTriangle);
  ask(QuestionKind::ray, ray_numbers({1.5, 0, 0}, {1, 0, 0}));
  EXPECT_EQ(answers_.answers[0], Verdict::miss);
}

/// How far a point is inside the unit cube about a pose's origin, as the pose has it exactly; below 0: outside.
mpq_class depth_in_cube(const Vec3& point, const Pose& pose) {
  const mpq_class w(pose.rotation.w());
  const mpq_class u[3] = {-pose.rotation.x(), -pose.rotation.y(), -pose.rotation.z()};
  mpq_class v[3];
  for (int i = 0; i < 3; ++i) v[i] = mpq_class(point[i]) - mpq_class(pose.position[i]);
  const mpq_class u2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
  const mpq_class along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  mpq_class depth = 1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const mpq_class back =
        ((w * w - u2) * v[i] + 2 * along * u[i] + 2 * w * (u[j] * v[k] - u[k] * v[j])) / (w * w + u2);
    depth = std::min(depth, mpq_class(1 - abs(back)));
  }
  return depth;
}

// A point in a posed solid may be outside of it where double places it: then the ray was inside, and never left.
TEST_F(WorldFromInside, ARayFromAHairInsideLeavesAgain) {
  const Pose poses[] = {
      {.position = {0, 0, 0}, .rotation = Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5))},
      {.position = {1000.1, 5, -2},
       .rotation = Quat(0.4128646082229567, -0.40107050612173456, 0.7799693071500643, -0.2456280608969762)},
      {.position = {0.25, 0.5, 0}, .rotation = Quat(1.0000005, 0, 0, 1e-9)}};
  std::mt19937_64 random = oracle::seeded(482);
  std::uniform_real_distribution<double> unit(-1, 1);
  int hair_count = 0;
  for (const Pose& pose : poses) {
    add("cube", scenes::box({1, 1, 1}), pose);
    const Frame frame = frame_of(pose);
    for (int i = 0; i < 300; ++i) {
      Vec3 local(0.9 * unit(random), 0.9 * unit(random), 0.9 * unit(random));
      local[i % 3] = unit(random) < 0 ? -1 : 1;
      Vec3 point = place(frame, local);
      for (double& x : point) x = std::nextafter(x, unit(random) < 0 ? -9e9 : 9e9);
      const mpq_class depth = depth_in_cube(point, pose);
      ask(QuestionKind::ray, ray_numbers(point, Vec3(unit(random), unit(random), unit(random))));
      if (depth <= 0) continue;
      ++hair_count;
      ASSERT_EQ(answers_.hits.size(), 1u) << i;
      const AnswerHit& hit = answers_.hits[0];
      ASSERT_EQ(hit.flags, kHitInside) << i;
      EXPECT_EQ(hit.distance_m, 0);
      EXPECT_TRUE(std::isfinite(hit.exit_m)) << i;
      ask(QuestionKind::near, {point.x(), point.y(), point.z(), INFINITY}, HitMode::signed_near, 1);
      const mpq_class low = mpq_class(-answers_.hits[0].distance_m) - mpq_class(answers_.hits[0].error_m);
      const mpq_class high = mpq_class(-answers_.hits[0].distance_m) + mpq_class(answers_.hits[0].error_m);
      EXPECT_TRUE(low <= depth && depth <= high) << i;
    }
    world_.remove(*world_.find("cube"), EndReason::removed);
    step();
  }
  EXPECT_GT(hair_count, 200);
}

// The same of primitives: inside or not, and how near, is that of the box as given.
TEST_F(WorldFromInside, NearIsDecidedForAPosedBoxAsGiven) {
  std::mt19937_64 random = oracle::seeded(483);
  std::uniform_real_distribution<double> unit(-1, 1);
  int held_count = 0;
  for (int i = 0; i < 400; ++i) {
    const Pose pose{.position = 100 * Vec3(unit(random), unit(random), unit(random)),
                    .rotation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized()};
    ObjectDefinition definition;
    definition.name = "box";
    definition.pose = pose;
    definition.shape.primitives = {Box{.center = Vec3::Zero(), .half_m = Vec3::Ones()}};
    ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
    step();
    Vec3 local(0.9 * unit(random), 0.9 * unit(random), 0.9 * unit(random));
    local[i % 3] = 1;
    const Vec3 point = place(frame_of(pose), local);
    const mpq_class depth = depth_in_cube(point, pose);
    held_count += depth >= 0 ? 1 : 0;
    ask(QuestionKind::near, {point.x(), point.y(), point.z(), 0});
    EXPECT_EQ(answers_.hits.size(), depth >= 0 ? 1u : 0u) << i;
    for (const HitMode mode : {HitMode::closest, HitMode::signed_near}) {
      ask(QuestionKind::near, {point.x(), point.y(), point.z(), INFINITY}, mode, 1);
      const AnswerHit& hit = answers_.hits.at(0);
      EXPECT_EQ(hit.flags, depth >= 0 ? kHitInside : 0) << i;
      const mpq_class truth = depth >= 0 && mode == HitMode::closest ? mpq_class(0) : mpq_class(-depth);
      EXPECT_TRUE(abs(mpq_class(hit.distance_m) - truth) <= mpq_class(hit.error_m)) << i << ' ' << hit.distance_m;
    }
    world_.remove(*world_.find("box"), EndReason::removed);
    step();
  }
  EXPECT_GT(held_count, 100);
  EXPECT_LT(held_count, 300);
}

// From an outside examination: each is an ulp within or beyond the distance, by rationals.
TEST_F(WorldFromInside, WithinADistanceIsDecidedToTheLastBit) {
  struct Case {
    Vec3 half_m, center, position, point;
    double within_m;
  };
  const Case cases[] = {{{1.8588536855915707, 1.061294002889197, 1.7390262734251118},
                         {1.170050670032673, -1.3765477120845342, 1.2847207318622194},
                         {1.143232262125165, -7.778124547613806e-18, 3.053323330569399e-11},
                         {3.0289043556242436, -0.31525370919533713, 3.023747005287331},
                         0},
                        {{0, 9.781023831221063, 9.781023831221066},
                         {9.781023831221063, 9.781023831221066, 9.781023831221065},
                         {9.781023831221065, 9.781023831221061, 9.781023831221066},
                         {9.781023831221063, 19.56204766244213, 19.562047662442133},
                         9.781023831221063},
                        {{0, 1659936066336.6692, 1659936066336.6697},
                         {1659936066336.67, 1659936066336.67, 1659936066336.6697},
                         {1659936066336.6697, -1659936066336.6694, 1659936066336.6692},
                         {1659936066336.67, 1659936066336.6694, 1659936066336.6692},
                         1659936066336.6697}};
  for (const Case& one : cases) {
    add("box", Box{.center = one.center, .half_m = one.half_m}, one.position);
    mpq_class square = 0;
    for (int i = 0; i < 3; ++i) {
      const mpq_class away = abs(mpq_class(one.point[i]) - mpq_class(one.center[i]) - mpq_class(one.position[i])) -
                             mpq_class(one.half_m[i]);
      if (away > 0) square += away * away;
    }
    const mpq_class within(one.within_m);
    ask(QuestionKind::near, {one.point.x(), one.point.y(), one.point.z(), one.within_m});
    EXPECT_EQ(answers_.answers[0] == Verdict::hit, square <= within * within) << one.within_m;
    ask(QuestionKind::near, {one.point.x(), one.point.y(), one.point.z(), INFINITY});
    const AnswerHit& hit = answers_.hits.at(0);
    const mpq_class low = mpq_class(hit.distance_m) - mpq_class(hit.error_m);
    const mpq_class high = mpq_class(hit.distance_m) + mpq_class(hit.error_m);
    EXPECT_TRUE((low <= 0 || low * low <= square) && square <= high * high) << hit.distance_m << " +- " << hit.error_m;
    world_.remove(*world_.find("box"), EndReason::removed);
    step();
  }
}

// A ball of half a metre comes to a cube's face, or passes it: met or not is that of the cube as given, also of its mesh.
TEST_F(WorldFromInside, ASweepIsDecidedForAPosedCubeAsGiven) {
  std::mt19937_64 random = oracle::seeded(484);
  std::uniform_real_distribution<double> unit(-1, 1);
  ObjectInfo mover;
  mover.primitives = {Sphere{Vec3::Zero(), 0.5}};
  int met_count = 0;
  for (int i = 0; i < 400; ++i) {
    const Pose pose{.position = 100 * Vec3(unit(random), unit(random), unit(random)),
                    .rotation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized()};
    if (i % 2 == 0) {
      add("cube", scenes::box({1, 1, 1}), pose, false);
    } else {
      ObjectDefinition definition;
      definition.name = "cube";
      definition.pose = pose;
      definition.shape.primitives = {Box{.center = Vec3::Zero(), .half_m = Vec3::Ones()}};
      ASSERT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
      step();
    }
    Vec3 local(0.9 * unit(random), 0.9 * unit(random), 0.9 * unit(random));
    local[i % 3] = unit(random) < 0 ? -1.5 : 1.5;
    const Vec3 outward = frame_of(pose).rotation * Vec3(local[i % 3] * Vec3::Unit(i % 3));
    const Vec3 end = place(frame_of(pose), local);
    const Vec3 begin = end + outward + 0.5 * outward.cross(Vec3(unit(random), unit(random), unit(random)));
    numbers_ = straight_numbers(begin, end);
    lease_ = world_.newest();
    question_ = {.kind = QuestionKind::sweep, .numbers = numbers_, .mover = &mover};
    answer(*lease_, question_, answers_, scratch_);
    const bool is_met = depth_in_cube(end, pose) >= mpq_class(-0.5);
    met_count += is_met ? 1 : 0;
    ASSERT_EQ(answers_.answers[0], is_met ? Verdict::hit : Verdict::miss) << i;
    if (is_met) {
      EXPECT_LE(answers_.brackets[0].high, 1);
      EXPECT_GT(answers_.brackets[0].high, 1 - 1e-5);
      EXPECT_NEAR(answers_.hits[0].normal.norm(), 1, 1e-12);
    }
    world_.remove(*world_.find("cube"), EndReason::removed);
    step();
  }
  EXPECT_GT(met_count, 100);
  EXPECT_LT(met_count, 300);
}

TEST_F(WorldFromInside, WhatIsNotAskedForDoesNotHoldARay) {
  load("solid", scenes::box({1, 1, 1}), "*");
  add("ball", Sphere{Vec3::Zero(), 0.1}, {0.5, 0, 0});
  numbers_ = ray_numbers({0, 0, 0}, {1, 0, 0});
  lease_ = world_.newest();
  question_ = {.kind = QuestionKind::ray, .skip = "solid", .numbers = numbers_};
  answer(*lease_, question_, answers_, scratch_);
  EXPECT_EQ(names(), "ball");
  expect_first(0.4);
}

/// Distance to the first of the mesh's triangles as placed, by rationals and without an index.
double exit_by_rationals(const Ray& ray, const TriangleMesh& mesh, const Pose& pose) {
  const Frame frame = frame_of(pose);
  double least_m = INFINITY;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    RayHit hit;
    if (exactly::cast_ray(ray, place(frame, mesh.triangle(i)), hit) == Decision::yes)
      least_m = std::min(least_m, hit.distance_m);
  }
  return least_m;
}

TEST_F(WorldFromInside, RandomRaysAreDecidedAsByRationals) {
  std::mt19937_64 random = oracle::seeded(171);
  std::normal_distribution<double> any;
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  int begun_inside = 0;
  int begun_outside = 0;
  for (int world = 0; world < 6; ++world) {
    const TriangleMesh mesh = scenes::rough_sphere(2, random);
    const Pose pose{.position = 3 * vector(), .rotation = Quat(any(random), any(random), any(random), any(random))};
    const bool is_scene = world % 3 == 2;
    if (is_scene) load("stone", mesh, "*");
    else add("stone", mesh, pose);
    const Pose where = is_scene ? Pose{} : pose;
    const oracle::SolidOracle truth(mesh);
    for (int i = 0; i < 150; ++i) {
      const Vec3 from = where.position + where.rotation.normalized() * Vec3(0.8 * vector());
      const Vec3 along = vector();
      const bool is_in = truth.side(oracle::seen_from(where, from), random) == SolidSide::in;
      ask(QuestionKind::ray, ray_numbers(from, along), HitMode::closest);
      const double exit_m = exit_by_rationals({.origin = from, .direction = along}, mesh, where);
      ASSERT_EQ(!answers_.hits.empty() && (answers_.hits[0].flags & kHitInside) != 0, is_in);
      if (is_in) {
        ++begun_inside;
        ASSERT_EQ(answers_.hits[0].distance_m, 0);
        ASSERT_NEAR(answers_.hits[0].exit_m, exit_m, 1e-12 * exit_m);
      } else {
        ++begun_outside;
        ASSERT_EQ(answers_.hits.empty(), std::isinf(exit_m));
        if (!answers_.hits.empty()) { ASSERT_NEAR(answers_.hits[0].distance_m, exit_m, 1e-12 * exit_m); }
      }
    }
    if (is_scene) world_.remove_scene("stone");
    else world_.remove(*world_.find("stone"), EndReason::removed);
    step();
  }
  EXPECT_GT(begun_inside, 200);
  EXPECT_GT(begun_outside, 200);
}

TEST_F(WorldFromInside, ASweepThatBeginsInASolidHasItsContactAtTheStart) {
  ObjectInfo mover;
  mover.primitives = {Box{.center = Vec3::Zero(), .half_m = {0.1, 0.1, 0.1}}};
  const auto sweep = [&](const Vec3& from, const Vec3& to) -> const Answers& {
    numbers_ = straight_numbers(from, to);
    lease_ = world_.newest();
    question_ = {.kind = QuestionKind::sweep, .numbers = numbers_, .mover = &mover};
    answer(*lease_, question_, answers_, scratch_);
    return answers_;
  };
  load("shell", scenes::box({1, 1, 1}), "");
  EXPECT_EQ(sweep({0, 0, 0}, {0.5, 0, 0}).answers[0], Verdict::miss) << "a surface holds nothing";
  world_.remove_scene("shell");
  for (const bool is_scene : {true, false}) {
    if (is_scene) load("solid", scenes::box({1, 1, 1}), "*");
    else add("solid", scenes::box({1, 1, 1}), {});
    // Within all the way, out through the surface, and begun on the surface.
    for (const double to : {0.5, 5.0}) {
      ASSERT_EQ(sweep({0.25, 0, 0}, {to, 0, 0}).hits.size(), 1u);
      EXPECT_EQ(names(), "solid");
      EXPECT_EQ(answers_.brackets[0].low, 0);
      EXPECT_EQ(answers_.brackets[0].high, 0);
      EXPECT_EQ(answers_.hits[0].flags, kHitInside);
      EXPECT_EQ(answers_.hits[0].normal, Vec3(1, 0, 0)) << "out of the solid";
    }
    ASSERT_EQ(sweep({1.05, 0, 0}, {5, 0, 0}).hits.size(), 1u);
    EXPECT_EQ(answers_.hits[0].flags, 0);
    EXPECT_EQ(answers_.brackets[0].high, 0);
    EXPECT_EQ(sweep({2, 0, 0}, {5, 0, 0}).answers[0], Verdict::miss);
    ASSERT_EQ(sweep({2, 0, 0}, {0, 0, 0}).hits.size(), 1u);
    EXPECT_NEAR(answers_.brackets[0].high, 0.45, 1e-6);
    if (is_scene) world_.remove_scene("solid");
    step();
  }
}

}  // namespace
}  // namespace collided::engine
