#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "server/world/audit/audit.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/query.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// A world with declared solids, each of whose answers is audited.
class SolidWorld : public testing::Test {
 protected:
  /// Loads a mesh as a scene of one part; returns what declaring it found.
  DeclaredSolids load(const std::string& name, const TriangleMesh& mesh, const std::string& solid) {
    Scene scene;
    scene.name = name;
    scene.mesh = mesh;
    scene.parts = {{.name = name,
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(mesh.triangles.size()),
                    .filter = {}}};
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    DeclaredSolids declared;
    if (!solid.empty()) declared = declare_solids(indexed.scene, *indexed.geometry, solid);
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world_.add_scene(indexed)));
    step();
    return declared;
  }
  void add(const std::string& name, const TriangleMesh& mesh, const Pose& pose, bool is_solid = true) {
    ObjectDefinition definition;
    definition.name = name;
    definition.pose = pose;
    definition.shape.mesh = std::make_shared<const TriangleMesh>(mesh);
    definition.indexed =
        indexed_mesh(definition.shape.mesh, Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}));
    SolidFindings findings;
    if (is_solid) definition.solid = solid_within(definition.indexed, findings);
    EXPECT_EQ(definition.solid != nullptr, is_solid) << findings.refusal;
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
    step();
  }
  void add(const std::string& name, const Primitive& primitive, const Vec3& at, bool moving = true) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives = {primitive};
    definition.pose.position = at;
    definition.moving = moving;
    EXPECT_TRUE(std::holds_alternative<ObjectId>(world_.define(definition)));
    step();
  }
  void step() { world_.step(time_ns_ += 1'000'000'000, 1, {}); }

  const Answers& ask(QuestionKind kind, std::vector<double> numbers, HitMode mode = HitMode::closest,
                     std::uint32_t max_hits = 1000) {
    numbers_ = std::move(numbers);
    lease_ = world_.newest();
    question_ = {.kind = kind, .mode = mode, .max_hits = max_hits, .numbers = numbers_};
    answer(*lease_, question_, answers_, scratch_);
    EXPECT_EQ(audit(*lease_, question_, answers_), "");
    return answers_;
  }
  const Answers& inside(const Vec3& p, HitMode mode = HitMode::closest) {
    return ask(QuestionKind::inside, {p.x(), p.y(), p.z()}, mode);
  }
  std::string names() {
    std::string text;
    for (const AnswerHit& hit : answers_.hits)
      text += (text.empty() ? "" : " ") + lease_->objects[slot_of(hit.object)]->name;
    return text;
  }
  void expect_first(double distance_m) {
    ASSERT_FALSE(answers_.hits.empty());
    const AnswerHit& hit = answers_.hits.front();
    EXPECT_NEAR(hit.distance_m, distance_m, hit.error_m);
    EXPECT_LT(hit.error_m, 1e-12);
  }

  World world_{WorldOptions{}};
  std::int64_t time_ns_ = 0;
  std::vector<double> numbers_;
  Questions question_;
  SnapshotRing::Lease lease_;
  Answers answers_;
  QueryScratch scratch_;
};

}  // namespace collided::engine
