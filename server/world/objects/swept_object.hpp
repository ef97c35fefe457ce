#pragma once

#include <cstdint>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "server/geometry/mesh.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A moving or resting body: the primitives and the mesh of an object, or a scene's triangles. Refers to its source,
/// which must outlive it.
struct SweptBody {
  BodyMotion motion;
  std::span<const Primitive> primitives;
  const TriangleMesh* mesh = nullptr;
  const Bvh* tree = nullptr;
  double mesh_reach_m = 0;    // largest distance of a vertex from the frame's origin, metres
  double mesh_placing_m = 0;  // BodyMotion::placing_m for every vertex
  bool is_scene = false;      // its own coordinates are those of the world

  SweptBody(const ObjectInfo& info, const BodyMotion& on);
  /// A scene's static triangles, in world coordinates, at rest.
  explicit SweptBody(const StaticScene& scene);
};

/// An origin from which both bodies are seen without rounding at every place (common_origin.hpp); 0 on each axis on
/// which they are not far out relative to their distance.
Vec3 common_origin(const SweptBody& a, const SweptBody& b);

/// A body in coordinates relative to an origin.
class SeenBody {
 public:
  SeenBody(const Vec3& origin, const SweptBody& body);
  SeenBody(const SeenBody&) = delete;
  SeenBody& operator=(const SeenBody&) = delete;

  const SweptBody& body() const { return body_; }

 private:
  SweptBody body_;
  Pose given_;  // what the motion's `given` points to
};

/// The first contact found so far. Times are fractions of the motion, 0 to 1.
struct SweptContact {
  bool yes = false;
  /// Some pair of parts, or the rest after the search ran out of room, is undecided: an earlier contact may exist, or
  /// one if none was found.
  bool undecided = false;
  bool is_cut_short = false;  // the search stopped at most_looks or its deadline
  std::uint32_t exact_tests = 0;
  /// No contact from the start of the span up to low; contact at high by the exact test.
  TimeBracket bracket;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;  // at bracket.high, normal from a to b

  /// Takes a contact if it is the earliest so far; among equal times the lowest triangles win. Returns true if it was
  /// taken.
  bool take(const TimeBracket& found, std::uint32_t a, std::uint32_t b);
};

/// Limits of a search.
struct SweepOptions {
  double width = 1e-6;   // width of the bracket, as a fraction of the motion
  TimeSpan span = {};    // the part of the motion that is searched
  bool contacts = true;  // compute the contact, not only its time
  /// Most pairs of parts, each at one time, that one search may test; the rest is undecided.
  std::uint32_t most_looks = 100'000;
  std::uint32_t* looks = nullptr;  // grows by the number of tests made; null: not counted
  Deadline* deadline = nullptr;    // null: none; the rest is undecided when it is over
};

/// The SweptContact that a triangle of b belongs to; null to ignore the triangle. Must return the same for every call
/// with a triangle.
using SweptContactOf = FunctionRef<SweptContact*(std::uint32_t triangle)>;

/// The first contact of two moving bodies, never late and never missed; for the bodies as given if their motions have
/// poses (BodyMotion::given). Divides the motion into pieces that are short for the number of parts near each other;
/// every pair of parts whose bounds may meet in a piece is tested for its first contact within it (part_motion.hpp).
///
/// threads  any; allocates
void sweep(const SweptBody& a, const SweptBody& b, const SweepOptions& options, WalkCost& cost, SweptContact& touch);

/// Sweeps against a scene whose triangles belong to several touches and finds the first contact of each. False: the
/// search stopped early, and touches without a contact are undecided.
bool sweep_scene(const SweptBody& a, const SweptBody& scene, const SweepOptions& options, WalkCost& cost,
                 SweptContactOf touch_of);

}  // namespace collided::engine
