// Rays and sweeps that begin in a declared solid.
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
    EXPECT_EQ(hit.flags, kInside);
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
      ASSERT_EQ(!answers_.hits.empty() && (answers_.hits[0].flags & kInside) != 0, is_in);
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
      EXPECT_EQ(answers_.hits[0].flags, kInside);
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
