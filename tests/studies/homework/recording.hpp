#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/objects/object.hpp"

namespace collided::homework {
using namespace engine;

struct Problem {
  std::size_t objects = 20;
  std::size_t polygons = 256;  // of an object, about
  double relative_size = 0.2;  // mean diameter over the cube's side
  std::size_t frames = 24;     // recorded
  std::uint64_t seed = 2000;
};

/// Spheres of polygons that moved about in a cube of 1 m: what every method gets to see.
struct Recording {
  std::vector<std::shared_ptr<const IndexedMesh>> sizes;  // sixteen at most, so that a hundred thousand objects fit
  std::vector<std::size_t> size_of;                       // one an object
  std::vector<std::vector<Pose>> poses;                   // by frame, then by object
  std::size_t polygons = 0;                               // that an object came to

  std::size_t objects() const { return size_of.size(); }
  const IndexedMesh& mesh(std::size_t object) const { return *sizes[size_of[object]]; }
};

/// Random sizes (half to one and a half of the mean), velocities (up to 0.5 m/s an axis) and angular velocities (up to
/// 3 rad/s), walls that mirror, and two that touch turn round once a contact. Same problem, same bits.
Recording record(const Problem& problem);

}  // namespace collided::homework
