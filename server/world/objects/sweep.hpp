#pragma once

#include <cstdint>
#include <optional>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/swept_object.hpp"

namespace collided::engine {

/// The sphere that is the whole object, if it is a single sphere: such objects are always swept between their poses.
std::optional<Sphere> lone_sphere(const ObjectInfo& info);
/// The box that is the whole object, in its own frame; null if it is anything else.
const Box* lone_box(const ObjectInfo& info);

/// A moving sphere, and the earliest contact found so far.
struct SphereSweep {
  MovingSphere mover;
  // Width of the bracket, as a fraction of the motion.
  double width = 0;
  bool contacts = true;     // compute the contact, not only its time
  SweptContact found = {};  // a is the sphere
};

/// Contains the sphere at every time of its motion.
Aabb bounds(const MovingSphere& mover);

/// Sweeps the sphere against one triangle, or against all near parts of an object at rest; sweep.found keeps the
/// earliest. Far from the world's origin both are seen from the other's place, so that the end of the sphere's path
/// loses no digits.
void sweep_part(SphereSweep& sweep, const Triangle& part, std::uint32_t triangle);
void sweep_object(SphereSweep& sweep, const Placed& other, WalkCost& cost);

/// The same contact with a and b exchanged.
SweptContact turned_round(SweptContact touch);
ContactSearch turned_round(ContactSearch touch);

/// Largest distance of a point of the object from its frame's origin, metres; half-spaces, which never move, count as
/// 0.
double reach_of(const ObjectInfo& info);

/// An upper bound on the angle between the two frames, radians.
double most_turn_rad(const Frame& from, const Frame& to);

/// An upper bound on how far a point within reach_m of the origin moves between the two frames.
double longest_displacement_m(const Frame& from, const Frame& to, double reach_m);

/// A box that contains the object at every time of the motion.
Aabb bounds(const ObjectInfo& info, const BodyMotion& motion, double reach_m);
/// quick_bounds() does the same for the motion between two frames, from the object's bounds at the last one: somewhat
/// wider, but without computing the rotation's arc cosine.
Aabb quick_bounds(const ObjectInfo& info, const Frame& from, const Frame& to, const Aabb& bounds_at_end,
                  double reach_m);

/// A box that moves straight and contains an object throughout its motion, for the bounds of parts of long motions.
class StraightWay {
 public:
  /// For a sphere: from the positions of its centre.
  explicit StraightWay(const MovingSphere& sphere);
  /// Takes any object.
  ///
  /// bounds_at_end  the object's bounds at the end of the motion
  /// reach_m        largest distance of a point from the frame's origin, plus more than twice the pivot's distance, if
  ///                there is one
  StraightWay(const BodyMotion& motion, const Aabb& bounds_at_end, double reach_m);

  const Vec3& travel() const { return travel_; }
  Vec3 size() const { return around_.high - around_.low; }
  /// Contains the object from time `begin` to `end`, as fractions of the motion.
  Aabb between(double begin, double end) const;
  bool is_finite() const { return start_.allFinite() && travel_.allFinite() && size().allFinite(); }

 private:
  Vec3 start_;
  Vec3 travel_;
  Aabb around_;  // box of the object relative to the point that moves straight
};

}  // namespace collided::engine
