#pragma once

#include <cstdint>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "server/geometry/mesh.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Something on its way, or resting: the primitives and the mesh of an object, or a scene's triangles.
struct SweptBody {
  BodyMotion motion;
  std::span<const Primitive> primitives;
  const TriangleMesh* mesh = nullptr;
  const Bvh* tree = nullptr;
  double mesh_reach_m = 0;  // no vertex is farther from the frame's origin

  SweptBody(const ObjectInfo& info, const BodyMotion& on);
  /// Static triangles, in world coordinates.
  explicit SweptBody(const StaticScene& scene);
};

/// The first contact found so far.
struct SweptTouch {
  bool yes = false;
  /// Some pair of parts, or all that the search had no room for, is open: another contact may be earlier than this one,
  /// or there may be one where none was found.
  bool undecided = false;
  bool is_cut_short = false;  // the search had no room for all of it
  std::uint32_t exact_tests = 0;
  /// No contact in [0, low]; contact at high, by the exact test.
  TimeBracket bracket;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;  // at bracket.high, normal from a to b

  /// The earliest contact wins; of equal ones that with the lowest numbers. True: it is this one.
  bool take(const TimeBracket& found, std::uint32_t a, std::uint32_t b);
};

struct SweepOptions {
  double width = 1e-6;  // of the bracket, as a fraction of the way
  bool contacts = true;
  /// Pairs of parts, each at one time, that one search may look at; beyond, what is not decided is undecided.
  std::uint32_t most_looks = 100'000;
};

/// To whom a triangle of b counts: null for nobody. The same for every call with the same triangle.
using TouchOf = FunctionRef<SweptTouch*(std::uint32_t triangle)>;

/// The first contact of two bodies on their ways. Never late, never missed: the way is cut into pieces that are short
/// for how much there is to meet, and every pair of parts whose bounds may meet in one is asked for the first contact
/// in it (part_motion.hpp).
///
/// threads  any; allocates
void sweep(const SweptBody& a, const SweptBody& b, const SweepOptions& options, WalkCost& cost, SweptTouch& touch);

/// The same for a scene's triangles that count to several: the first contact with each of them. False: the search ended
/// early, and those without contact are undecided.
bool sweep_scene(const SweptBody& a, const SweptBody& scene, const SweepOptions& options, WalkCost& cost, TouchOf touch_of);

}  // namespace collided::engine
