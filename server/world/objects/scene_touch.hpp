#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "server/geometry/common_origin.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// A part of a static scene that was touched, or that may have been if touch.undecided.
struct PartContact {
  std::uint32_t part = 0;
  ContactSearch touch;
};

/// The touched parts of a scene, in the order of their first candidates.
class PartContacts {
 public:
  explicit PartContacts(bool contacts_wanted) : wanted_(contacts_wanted) {}

  void clear(bool contacts_wanted) {
    wanted_ = contacts_wanted;
    list_.clear();
  }
  /// The search of a part, started at the part's first candidate; the reference is valid until the next call.
  ContactSearch& of(std::uint32_t part) {
    // Neighbouring triangles usually belong to the same part, so check the last one first.
    if (!list_.empty() && list_.back().part == part) return list_.back().touch;
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const PartContact& t) { return t.part == part; });
    if (found != list_.end()) return found->touch;
    list_.push_back({.part = part, .touch = {}});
    list_.back().touch.wanted = wanted_;
    return list_.back().touch;
  }
  const std::vector<PartContact>& list() const { return list_; }
  std::vector<PartContact>& list() { return list_; }

 private:
  bool wanted_;
  std::vector<PartContact> list_;
};

/// A square that no distance up to this one exceeds, even if the distance is the sum of two.
inline double square_up(double distance_m) {
  const double reach_m = distance_m * (1 + kFewSlack);
  return reach_m * reach_m * (1 + kFewSlack) + std::numeric_limits<double>::min();
}

/// Calls visit(triangle, part, corners) for each static triangle that may lie within sqrt(limit_m2) of the point and
/// whose part is allowed, roughly near to far. visit returns the new squared limit; a negative one ends the walk.
template <class Allowed, class Visit>
void visit_scene_near(const StaticScene& scene, const Vec3& point, double limit_m2, WalkCost& cost, Allowed&& allowed,
                      Visit&& visit) {
  const auto candidate = [&](std::uint32_t triangle, double limit) {
    const std::uint32_t part = scene.part_of(triangle);
    return allowed(part) ? visit(triangle, part, scene.mesh.triangle(triangle)) : limit;
  };
  scene.tree.walk_near(point, limit_m2, 0, candidate, cost);
}

/// Calls visit(triangle, part, corners) for each static triangle near the box whose part is allowed. allowed(part)
/// returns bool; visit returns bool, and false ends the walk.
template <class Allowed, class Visit>
void visit_scene(const StaticScene& scene, const Aabb& near, WalkCost& cost, Allowed&& allowed, Visit&& visit) {
  const auto candidate = [&](std::uint32_t triangle) {
    const std::uint32_t part = scene.part_of(triangle);
    return !allowed(part) || visit(triangle, part, scene.mesh.triangle(triangle));
  };
  scene.tree.walk_box(near, candidate, cost);
}

/// An origin from which the scene's triangles and a frame are seen without rounding (common_origin.hpp).
inline Vec3 common_origin(const StaticScene& scene, const Frame& frame) {
  return common_origin(frame.position, {scene.tree.bounds().low, scene.tree.bounds().high});
}

/// Calls visit(triangle, corners, mover_triangle, mover_corners) for each pair of a static triangle and one of the mesh
/// at the frame that may meet, or come within gap_m; the corners are relative to the origin. visit returns bool; false
/// ends the walk.
template <class Visit>
void visit_scene_pairs(const StaticScene& scene, const IndexedMesh& mesh, const Frame& frame, const Vec3& origin,
                       WalkCost& cost, Visit&& visit, double gap_m = 0) {
  const Frame seen = seen_from(origin, frame);
  PlacedTriangles placed(*mesh.mesh, seen);
  const auto candidate = [&](std::uint32_t triangle, std::uint32_t mover_triangle) {
    return visit(triangle, seen_from(origin, scene.mesh.triangle(triangle)), mover_triangle, placed.at(mover_triangle));
  };
  const double slack_m = placement_slack(frame, 0, mesh.radius_m);
  scene.tree.walk_pairs(mesh.tree, frame.rotation, frame.position, slack_m + gap_m, candidate, cost);
}

}  // namespace collided::engine
