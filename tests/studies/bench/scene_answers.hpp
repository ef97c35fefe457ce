#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "server/world/objects/snapshot.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::bench {
using namespace engine;

/// A mesh as the server holds it, and whole answers about it: what a user gets, all columns filled.
class SceneAnswers {
 public:
  explicit SceneAnswers(const TriangleMesh& mesh) : world_({}) {
    Scene scene{.name = "scene", .mesh = mesh, .parts = {}, .objects = {}};
    scene.parts.push_back({.name = "scene", .triangle_count = static_cast<std::uint32_t>(mesh.triangles.size())});
    indexed_ = World::index_scene(std::move(scene), {.progress = {}, .cancelled = {}, .form = BvhForm::best});
    world_.add_scene(indexed_);
    world_.step(0, 1, {});
    snapshot_ = world_.newest();
  }
  const StaticScene& scene() const { return *indexed_.geometry; }
  double bytes_a_triangle() const {
    return static_cast<double>(indexed_.geometry->bytes()) /
           static_cast<double>(indexed_.geometry->mesh.triangles.size());
  }
  /// Valid until the next call.
  const Answers& ask(QuestionKind kind, HitMode mode, std::span<const double> numbers, std::uint32_t max_hits,
                     bool with_hits = true) {
    answer(*snapshot_, {.kind = kind, .mode = mode, .with_hits = with_hits, .max_hits = max_hits, .numbers = numbers},
           answers_, scratch_);
    return answers_;
  }

 private:
  World world_;
  IndexedScene indexed_;
  SnapshotRing::Lease snapshot_;
  Answers answers_;
  QueryScratch scratch_;
};

}  // namespace collided::bench
