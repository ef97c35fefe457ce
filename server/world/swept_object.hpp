#pragma once

#include <cstdint>

#include "server/broad_phase/bsp_tree.hpp"
#include "server/exact_phase/time_of_contact.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/object.hpp"

namespace collided {

/// An object on its way from one accepted pose to the next, in the time from 0 to 1.
///
/// Without turning, a mesh's vertices go straight between the places that they have at the two poses, and primitives
/// are moved by t (to - from). A mesh that turns does so at even angular speed about its frame's origin; its way is cut
/// into so many pieces that no vertex, going straight in each, is ever farther than deviation_m from where it should be
/// (and the rounding of placing it).
struct ObjectWay {
  const ObjectInfo* info = nullptr;
  Frame from;
  Frame to;
};

struct SweepOptions {
  double width = 1e-6;
  double deviation_m = 1e-6;
};

/// The first contact of a moving object with static triangles.
struct FirstTouch {
  bool yes = false;
  /// Some part could not be answered: of a kind that is not offered here, turning without being a mesh, or turning
  /// farther than the pieces allow. No contact found is then no answer.
  bool undecided = false;
  /// No contact in [0, low], contact in [low, high]: exact for the straight ways, which deviate by deviation_m.
  TimeBracket bracket;
  double deviation_m = 0;
  std::uint32_t mover_triangle = wire_contract::kNoTriangle;
  std::uint32_t triangle = wire_contract::kNoTriangle;
  std::uint32_t exact_tests = 0;
};

/// Box, capsule, sphere and mesh parts against the triangles of a mesh, both in world coordinates with its index.
FirstTouch first_touch(const ObjectWay& way, const TriangleMesh& mesh, const BspTree& tree, const SweepOptions& options,
                       WalkCost& cost);

}  // namespace collided
