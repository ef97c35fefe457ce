// A power of two changes no digit: a whole world that answers differently at another size holds a constant in metres.
#include <gtest/gtest.h>

#include "tests/extreme/mixed.hpp"
#include "tests/extreme/transformed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_scaled_world_test {
namespace {

extreme::Cast scaled(extreme::Cast cast, const extreme::Scaling& scale) {
  for (ObjectDefinition& body : cast.movers) {
    body.pose.position = scale(body.pose.position);
    for (Primitive& primitive : body.shape.primitives) {
      primitive = std::visit([&](const auto& own) { return Primitive(scale(own)); }, primitive);
    }
    if (!body.shape.mesh) continue;
    TriangleMesh mesh = *body.shape.mesh;
    for (Vec3& vertex : mesh.vertices) vertex = scale(vertex);
    body.shape.mesh = extreme::shared_mesh(mesh);
  }
  for (Vec3& vertex : cast.scene.vertices) vertex = scale(vertex);
  return cast;
}

/// A box's last four numbers are its rotation.
std::vector<double> scaled(std::vector<double> numbers, QuestionKind kind, const extreme::Scaling& scale) {
  const bool box = kind == QuestionKind::box;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!box || i % kBoxNumbers < 6) numbers[i] = scale(numbers[i]);
  }
  return numbers;
}

TEST(ExtremeInvarianceScaledWorld, EveryAnswerAndContactIsTheSame) {
  std::mt19937_64 random = oracle::seeded(441);
  for (const extreme::Ground ground : extreme::kGrounds) {
    extreme::Mixer mixer(random, ground);
    const extreme::Cast cast = mixer.cast(60);
    std::vector<std::vector<double>> questions;
    for (const auto kind : extreme::kKinds) questions.push_back(mixer.questions(kind, 100));
    extreme::Stage original;
    extreme::build(original, cast);
    for (const int power : {-400, -100, -40, 40, 100, 400}) {
      const extreme::Scaling scale{power};
      extreme::Stage other;
      extreme::build(other, scaled(cast, scale));
      ASSERT_EQ(extreme::open_pairs(other.world), extreme::open_pairs(original.world)) << "2^" << power;
      for (std::size_t k = 0; k < questions.size(); ++k) {
        SCOPED_TRACE("2^" + std::to_string(power) + ", kind " + std::to_string(k));
        extreme::expect_same_story(original.ask(extreme::kKinds[k], questions[k]),
                                   other.ask(extreme::kKinds[k], scaled(questions[k], extreme::kKinds[k], scale)),
                                   scale(1));
        if (HasFatalFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace collided::engine::invariance_scaled_world_test
