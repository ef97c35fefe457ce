#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/distance/triangle_depth.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/objects/deadline.hpp"
#include "server/world/objects/object.hpp"
#include "server/world/objects/part_index.hpp"

namespace collided::engine {

/// An object with its pose, and its bounds in world coordinates.
struct Placed {
  const ObjectInfo* info = nullptr;
  Frame frame;
  Aabb bounds;
  const Pose* pose = nullptr;  // pose that the frame was made from; null if none was given, as between two poses

  /// One of its parts as it was given.
  GivenPart given(const Primitive& own) const {
    return pose == nullptr ? GivenPart{} : GivenPart{.own = &own, .pose = pose, .frame = &frame};
  }
  GivenPart given(std::uint32_t triangle) const {
    if (pose == nullptr) return {};
    return {.own = info->mesh->mesh->triangle(triangle), .pose = pose, .frame = &frame};
  }
};

/// A placed object in coordinates that count from an origin (common_origin.hpp).
class SeenPlaced {
 public:
  SeenPlaced(const Vec3& origin, const Placed& object);
  SeenPlaced(const SeenPlaced&) = delete;
  SeenPlaced& operator=(const SeenPlaced&) = delete;

  const Placed& placed() const { return placed_; }

 private:
  Placed placed_;
  Pose pose_;  // what placed_.pose points to
};

/// A triangle of one mesh and one of another, by number.
using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Result of testing two objects part by part so far. A part is a primitive or a triangle. The contact is that of the
/// deepest pair of parts (ties: lowest triangles), so it does not depend on the order of the tests.
struct ContactSearch {
  bool wanted = true;  // compute contacts from all pairs of parts; else the first touching pair ends the search
  // yes: a pair of parts touches. undecided: a pair was not decided.
  bool yes = false;
  bool undecided = false;
  Level level = Level::filter;  // the hardest arithmetic that any pair needed
  std::uint32_t exact_tests = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;
  Deadline* deadline = nullptr;  // null: no deadline
  TrianglePairs* met = nullptr;  // receives pairs that overlap as placed; null: not wanted, or there were too many

  /// True if no further pair can change the answer, or the time is over.
  bool done() const { return (yes && !wanted) || (deadline != nullptr && deadline->is_over()); }
  /// Moves the contact, found in coordinates relative to the origin, back to world coordinates.
  void move_back_from(const Vec3& origin) {
    if (yes && wanted) contact.point = back_from(origin, contact.point);
  }
};

/// Tests two parts in world coordinates; a triangle gives its number, a primitive kNoTriangle. If placing them rounds
/// more than the answer has margin, decides for the parts as given.
template <class A, class B>
void search_parts(const A& a, std::uint32_t a_triangle, const B& b, std::uint32_t b_triangle, ContactSearch& touch,
                  const GivenPair& given);

/// Tests a primitive in world coordinates against an object; `given` is the primitive as it was given.
void search_object(const Primitive& a, const GivenPart& given, const Placed& b, ContactSearch& touch, WalkCost& cost);

/// Tests two objects; the contact's normal points from a to b. Far from the world's origin both are seen from b's
/// place, so that placing them rounds no more than near the origin.
///
/// touch  has found nothing yet
void search_objects(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost);

/// Never ends a walk.
inline constexpr auto kNeverOver = [] { return false; };

/// Offers pairs of the two objects' triangles that may be within gap_m of each other, as Bvh::walk_pairs does; both
/// must have a mesh.
void walk_mesh_pairs(const Placed& a, const Placed& b, Bvh::PairCandidate candidate, Bvh::Interrupt is_over,
                     WalkCost& cost, double gap_m = 0);

/// Offers pairs of the two objects' triangles that may be within limit_m of each other, as Bvh::walk_near_pairs does;
/// both must have a mesh.
void walk_near_mesh_pairs(const Placed& a, const Placed& b, double limit_m, Bvh::NearPairCandidate candidate,
                          Bvh::Interrupt is_over, WalkCost& cost);

/// A box that contains every point of the shape, both at its exact place and where place() puts it.
Aabb bounds_as_given(const Frame& frame, const Primitive& own);

/// A box that contains every point of the object at the frame.
Aabb bounds_of(const ObjectInfo& info, const Frame& frame);

/// A box in the frame's coordinates that contains everything `world` may hold, including the rounding of placing.
///
/// reach_m  how far from the frame's origin the local points are
Aabb seen_from(const Frame& frame, const Aabb& world, double reach_m);

/// Calls visit(primitive) for the object's primitives, in its own frame, that may meet the box; false ends the visit.
template <class Visit>
void visit_primitives_near(const ObjectInfo& info, const Frame& frame, const Aabb& world, WalkCost& cost,
                           Visit&& visit) {
  if (!info.rare->parts) {
    for (const Primitive& primitive : info.primitives) {
      if (!visit(primitive)) return;
    }
    return;
  }
  const auto candidate = [&](std::uint32_t number) { return static_cast<bool>(visit(info.primitives[number])); };
  info.rare->parts->tree.walk_box(seen_from(frame, world, info.rare->parts->radius_m), candidate, cost);
}

/// Rounding of placing a point and transforming it back to a frame, metres: local bounds must grow by it so that no
/// placed point is lost (derivation at kPlacementRoundoffs).
double placement_slack(const Vec3& frame_position, double distance_m, double reach_m);
inline double placement_slack(const Frame& frame, double distance_m, double reach_m) {
  return placement_slack(frame.position, distance_m, reach_m);
}

/// A mesh's triangles at a frame. Caches the last one, since walks over pairs return to it repeatedly.
class PlacedTriangles {
 public:
  PlacedTriangles(const TriangleMesh& mesh, const Frame& frame) : mesh_(mesh), frame_(frame) {}

  const Triangle& at(std::uint32_t triangle) {
    if (triangle != last_) {
      placed_ = place(frame_, mesh_.triangle(triangle));
      last_ = triangle;
    }
    return placed_;
  }

 private:
  const TriangleMesh& mesh_;
  const Frame& frame_;
  std::uint32_t last_ = kNoTriangle;
  Triangle placed_;
};

/// True if this contact replaces `best`: it is deeper, or as deep with lower triangles.
inline bool deeper(const Contact& contact, std::uint32_t a_triangle, std::uint32_t b_triangle,
                   const ContactSearch& best) {
  if (!best.yes || contact.depth_m != best.contact.depth_m) return !best.yes || contact.depth_m > best.contact.depth_m;
  return a_triangle != best.a_triangle ? a_triangle < best.a_triangle : b_triangle < best.b_triangle;
}

/// Bound on how far two placed parts together may be from the given ones, metres.
double placing_error_m(const ConvexPart& a, const ConvexPart& b, const GivenPair& given);

/// True or false for the parts as given and as placed if one filter in double decides both; only for two boxes.
Decision quickly_decided(const Primitive& a, const Primitive& b, double off_m);

/// Decides exactly whether the parts as given touch. verdict: the decision for the placed parts, which are off by at
/// most off_m.
ExactResult decided_as_given(const ConvexPart& a, const ConvexPart& b, const GivenPair& given, double off_m,
                             ExactResult verdict);

/// The contact of two parts that touch as given; as placed they may be a few roundings apart.
Contact contact_as_given(const ConvexPart& a, const ConvexPart& b);

template <class A, class B>
void search_parts(const A& a, std::uint32_t a_triangle, const B& b, std::uint32_t b_triangle, ContactSearch& touch,
                  const GivenPair& given) {
  // If another contact is known, one that depends on a rounding adds nothing: its depth would be 0.
  const double off_m = touch.yes || given.is_exact() ? 0 : placing_error_m(a, b, given);
  Decision quick = Decision::undecided;
  if constexpr (std::same_as<A, Primitive> && std::same_as<B, Primitive>) {
    if (off_m > 0) quick = quickly_decided(a, b, off_m);
  }
  if (off_m > 0 && (quick == Decision::no || (quick == Decision::undecided && surely_apart(a, b, off_m)))) {
    ++touch.exact_tests;
    return;
  }
  double depth_at_most_m = std::numeric_limits<double>::infinity();
  ExactResult verdict{quick, Level::filter};
  if (quick == Decision::yes) {
    // Shapes closer to the boundary than the placing error are not decided here.
  } else if constexpr (requires { overlaps(a, b, depth_at_most_m); }) {
    verdict = touch.wanted && touch.yes ? overlaps(a, b, depth_at_most_m) : overlaps(a, b);
  } else {
    verdict = overlaps(a, b);
  }
  ++touch.exact_tests;
  const bool meet_as_placed = verdict.yes();
  if (meet_as_placed && touch.met != nullptr) touch.met->emplace_back(a_triangle, b_triangle);
  if (off_m > 0 && quick != Decision::yes) verdict = decided_as_given(a, b, given, off_m, verdict);
  touch.level = std::max(touch.level, verdict.level);
  if (verdict.decision == Decision::undecided) touch.undecided = true;
  if (!verdict.yes()) return;
  if constexpr (std::same_as<A, Triangle> && std::same_as<B, Triangle>) {
    if (touch.wanted && touch.yes) depth_at_most_m = kernel::depth_at_most(a, b, touch.contact.depth_m);
  }
  if (touch.wanted && !(touch.yes && depth_at_most_m < touch.contact.depth_m)) {
    const Contact found = meet_as_placed ? contact(a, b) : contact_as_given(a, b);
    if (deeper(found, a_triangle, b_triangle, touch)) {
      touch.contact = found;
      touch.a_triangle = a_triangle;
      touch.b_triangle = b_triangle;
    }
  }
  touch.yes = true;
}

}  // namespace collided::engine
