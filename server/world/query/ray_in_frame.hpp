#pragma once

#include <cmath>
#include <cstdint>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// An index of `count` items in an object's frame, with no point farther than radius_m from the frame's origin.
struct LocalIndex {
  const Bvh& tree;
  double radius_m = 0;
  std::size_t count = 0;
};

/// Calls candidate(number) for the items that the ray may meet, near to far; it returns the new limit, in lengths of
/// the ray's direction; a negative one ends the walk.
template <class Candidate>
void walk_ray_in_frame(const Ray& ray, double limit, const LocalIndex& index, const Frame& frame, WalkCost& cost,
                       Candidate&& candidate) {
  const Vec3 away = ray.origin - frame.position;
  const Ray local{.origin = frame.rotation.transpose() * away, .direction = frame.rotation.transpose() * ray.direction};
  const double slack_m = placement_slack(frame, away.lpNorm<1>() + ray.origin.lpNorm<1>(), index.radius_m);
  // A ray that is not finite in this frame cannot be walked, so everything is a candidate.
  if (local.origin.allFinite() && local.direction.allFinite() && std::isfinite(slack_m)) {
    const auto offered = [&](std::uint32_t number, double) { return candidate(number); };
    // The limit is in lengths, which a rotation preserves up to the rounding of its matrix.
    index.tree.walk_ray(local, limit * (1 + kChainSlack), slack_m, offered, cost);
    return;
  }
  for (std::uint32_t i = 0; i < index.count && limit >= 0; ++i) limit = candidate(i);
}

}  // namespace collided::engine
