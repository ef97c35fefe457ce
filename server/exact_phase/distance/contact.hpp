#pragma once

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// One contact of A and B. Moving B by depth_m along the normal separates them (up to depth_error_m).
/// |true depth - depth_m| <= depth_error_m, where the true depth is the length of the shortest separating translation.
struct Contact {
  Vec3 point = Vec3::Zero();   // in the middle of the overlap
  Vec3 normal = Vec3::Zero();  // unit, from A to B
  double depth_m = 0;
  double depth_error_m = 0;
};

/// The contact of two sets that overlap; call it only if `overlaps` returned yes.
Contact contact(const Sphere& a, const Sphere& b);
Contact contact(const Sphere& a, const Box& b);
Contact contact(const Sphere& a, const Capsule& b);
Contact contact(const Sphere& a, const Triangle& b);
Contact contact(const Box& a, const Box& b);
Contact contact(const Box& a, const Capsule& b);
Contact contact(const Box& a, const Triangle& b);
Contact contact(const Capsule& a, const Capsule& b);
Contact contact(const Capsule& a, const Triangle& b);
Contact contact(const Triangle& a, const Triangle& b);

/// Contact of primitives of any kinds; if the list above has only the other order, the contact is flipped.
Contact contact(const Primitive& a, const Primitive& b);
Contact contact(const Primitive& a, const Triangle& b);

}  // namespace collided::engine
