#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/objects/object.hpp"
#include "server/world/objects/part_index.hpp"

namespace collided::engine {

/// An object at its pose.
struct Placed {
  const ObjectInfo* info = nullptr;
  const Frame* frame = nullptr;
  Aabb bounds;
};

/// What testing two objects part by part has found so far. A part is a primitive or a triangle. The contact is that of
/// the deepest pair of parts (ties: lowest triangles), so it does not hang on the order of testing.
struct ContactSearch {
  bool wanted = true;  // contacts are computed, and all pairs of parts looked at; else the first yes ends the search
  bool yes = false;
  bool undecided = false;
  Level level = Level::filter;
  std::uint32_t exact_tests = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;

  bool done() const { return yes && !wanted; }
};


/// Two parts in world coordinates; a triangle names itself, a primitive is kNoTriangle.
template <class A, class B>
void search_parts(const A& a, std::uint32_t a_triangle, const B& b, std::uint32_t b_triangle, ContactSearch& touch);

/// A primitive in world coordinates against an object.
void search_object(const Primitive& a, const Placed& b, ContactSearch& touch, WalkCost& cost);

/// Two objects, a's contact normal towards b.
void search_objects(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost);

/// Pairs of the two objects' triangles that may meet, as Bvh::walk_pairs tells them; both have a mesh.
void walk_mesh_pairs(const Placed& a, const Placed& b, Bvh::PairCandidate candidate, WalkCost& cost,
                     double gap_m = 0);

/// Contains every point of the object at the frame.
Aabb bounds_of(const ObjectInfo& info, const Frame& frame);

/// A box around everything that `world` may hold, seen from the frame: generous by the rounding of placing points.
/// reach_m: how far from the frame's origin the local things are.
Aabb seen_from(const Frame& frame, const Aabb& world, double reach_m);

/// Calls visit(primitive) for the object's primitives, in its frame, that may meet the box; false ends the visit.
template <class Visit>
void visit_primitives_near(const ObjectInfo& info, const Frame& frame, const Aabb& world, WalkCost& cost, Visit&& visit) {
  if (!info.parts) {
    for (const Primitive& primitive : info.primitives) {
      if (!visit(primitive)) return;
    }
    return;
  }
  const auto candidate = [&](std::uint32_t number) { return static_cast<bool>(visit(info.primitives[number])); };
  info.parts->tree.walk_box(seen_from(frame, world, info.parts->radius_m), candidate, cost);
}

/// Rounding of placing and of seeing from a frame, metres: what local bounds must grow by so that no placed point is
/// lost (derivation at kPlacementRoundoffs).
double placement_slack(const Frame& frame, double distance_m, double reach_m);

/// A mesh's triangles at a frame; the last one is kept, since walks over pairs ask for it again and again.
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

/// Whether this contact names the pair of parts better than the one that `best` holds.
inline bool deeper(const Contact& contact, std::uint32_t a_triangle, std::uint32_t b_triangle, const ContactSearch& best) {
  if (!best.yes || contact.depth_m != best.contact.depth_m) return !best.yes || contact.depth_m > best.contact.depth_m;
  return a_triangle != best.a_triangle ? a_triangle < best.a_triangle : b_triangle < best.b_triangle;
}

template <class A, class B>
void search_parts(const A& a, std::uint32_t a_triangle, const B& b, std::uint32_t b_triangle, ContactSearch& touch) {
  double depth_at_most_m = std::numeric_limits<double>::infinity();
  ExactResult verdict;
  if constexpr (requires { overlaps(a, b, depth_at_most_m); }) {
    verdict = touch.wanted && touch.yes ? overlaps(a, b, depth_at_most_m) : overlaps(a, b);
  } else {
    verdict = overlaps(a, b);
  }
  ++touch.exact_tests;
  touch.level = std::max(touch.level, verdict.level);
  if (verdict.decision == Decision::undecided) touch.undecided = true;
  if (!verdict.yes()) return;
  if (touch.wanted && !(touch.yes && depth_at_most_m < touch.contact.depth_m)) {
    const Contact found = contact(a, b);
    if (deeper(found, a_triangle, b_triangle, touch)) {
      touch.contact = found;
      touch.a_triangle = a_triangle;
      touch.b_triangle = b_triangle;
    }
  }
  touch.yes = true;
}

}  // namespace collided::engine
