#pragma once

#include <cstdint>
#include <limits>
#include <unordered_set>
#include <vector>

#include "server/geometry/ray.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/world/groups/members.hpp"

namespace collided {
struct ExplainedMiss;
}

namespace collided::engine {

/// The search for the objects that a ray passes nearest without meeting them: by their boxes first, then exactly as far
/// as the nearest need it.
///
/// owner    snapshot and ask must outlive it
/// threads  one
class RayMisses {
 public:
  RayMisses(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes);

  /// Counts the boxes that the ray meets, and the objects that the filter excludes.
  ///
  /// met  objects that the ray meets
  void look_at_boxes(const std::unordered_set<ObjectId>& met, ExplainedRay& told);
  /// Fills told.misses. Call it after look_at_boxes().
  void find(Deadline& deadline, ExplainedRay& told);

 private:
  static constexpr double kNoLimit_m = std::numeric_limits<double>::infinity();

  struct Passed {
    std::uint32_t number = 0;  // index among the members
    double at_least_m = 0;     // lower bound on its distance
    bool is_box_met = false;
    bool is_left_out = false;
  };

  double least_distance_m(const Aabb& box) const;
  double reach_m(const Aabb& box) const;
  std::optional<ExplainedMiss> miss_of(const Passed& passed, double limit_m, Deadline& deadline);

  const Snapshot& snapshot_;
  const RayExplanationAsk& ask_;
  Ray ray_;
  Vec3 unit_;
  Members members_;
  std::vector<Passed> passed_;
  bool is_any_open_ = false;
};

}  // namespace collided::engine
