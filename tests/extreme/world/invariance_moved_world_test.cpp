// Moved by a representable offset or turned by a third about (1, 1, 1), no coordinate rounds: an answer that changes
// came from coordinates where differences were due, or from an axis that is treated better than another.
#include <gtest/gtest.h>

#include <functional>

#include "tests/extreme/mixed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_moved_world_test {
namespace {

/// What happens to points; turn is exact and its own quaternion.
struct Motion3 {
  Vec3 by = Vec3::Zero();
  Quat turn = Quat::Identity();

  Vec3 direction(const Vec3& v) const { return place(frame_of({.position = Vec3::Zero(), .rotation = turn}), v); }
  Vec3 point(const Vec3& v) const { return direction(v) + by; }
};

extreme::Cast moved(extreme::Cast cast, const Motion3& motion) {
  for (ObjectDefinition& body : cast.movers) {
    body.pose.position = motion.point(body.pose.position);
    body.pose.rotation = motion.turn;
  }
  for (Vec3& vertex : cast.scene.vertices) vertex = motion.point(vertex);
  return cast;
}

std::vector<double> moved(std::vector<double> numbers, QuestionKind kind, const Motion3& motion) {
  const bool ray = kind == QuestionKind::ray;
  const bool box = kind == QuestionKind::box;
  const std::size_t stride = ray ? kRayNumbers : box ? kBoxNumbers : kSphereNumbers;
  for (std::size_t i = 0; i < numbers.size(); i += stride) {
    double* n = numbers.data() + i;
    Eigen::Map<Vec3>{n} = motion.point(Eigen::Map<Vec3>(n));
    if (ray) Eigen::Map<Vec3>{n + 3} = motion.direction(Eigen::Map<Vec3>(n + 3));
    if (box) {
      n[6] = motion.turn.w();
      n[7] = motion.turn.x();
      n[8] = motion.turn.y();
      n[9] = motion.turn.z();
    }
  }
  return numbers;
}

void expect_unmoved(std::mt19937_64& random, extreme::Ground ground, const std::vector<Motion3>& motions) {
  extreme::Mixer mixer(random, ground);
  const extreme::Cast cast = mixer.cast(60);
  std::vector<std::vector<double>> questions;
  for (const auto kind : extreme::kKinds) questions.push_back(mixer.questions(kind, 100));
  extreme::Stage original;
  extreme::build(original, cast);
  for (const Motion3& motion : motions) {
    extreme::Stage other;
    extreme::build(other, moved(cast, motion));
    ASSERT_EQ(extreme::open_pairs(other.world), extreme::open_pairs(original.world));
    for (std::size_t k = 0; k < questions.size(); ++k) {
      SCOPED_TRACE("kind " + std::to_string(k));
      extreme::expect_same_story(original.ask(extreme::kKinds[k], questions[k]),
                                 other.ask(extreme::kKinds[k], moved(questions[k], extreme::kKinds[k], motion)), 1);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(ExtremeInvarianceMovedWorld, RepresentableOffsetsChangeNothing) {
  std::mt19937_64 random = oracle::seeded(451);
  for (const extreme::Ground ground : extreme::kGrounds) {
    expect_unmoved(random, ground,
                   {{.by = {0x1p10, -0x1p10, 0x1p10}}, {.by = {1e6, 0, -1e6}}, {.by = {-0x1p26, 1e8, 3}}});
  }
}

TEST(ExtremeInvarianceMovedWorld, ExactTurnsChangeNothing) {
  std::mt19937_64 random = oracle::seeded(452);
  for (const extreme::Ground ground : extreme::kGrounds) {
    expect_unmoved(random, ground,
                   {{.turn = Quat(0.5, 0.5, 0.5, 0.5)},
                    {.turn = Quat(0.5, -0.5, 0.5, -0.5)},
                    {.turn = Quat(0, 1, 0, 0)},
                    {.turn = Quat(0, 0, 0, 1)},
                    {.by = {1e6, 1e6, 1e6}, .turn = Quat(0.5, 0.5, -0.5, 0.5)}});
  }
}

}  // namespace
}  // namespace collided::engine::invariance_moved_world_test
