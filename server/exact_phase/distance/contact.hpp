#pragma once

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// One touching of A and B. Moving B by depth_m along the normal parts them (to depth_error_m).
/// |true depth - depth_m| <= depth_error_m, where the depth is the shortest translation that parts the two sets.
struct Contact {
  Vec3 point = Vec3::Zero();   // in the middle of the overlap
  Vec3 normal = Vec3::Zero();  // unit, from A to B
  double depth_m = 0;
  double depth_error_m = 0;
};

/// The contact of two sets that overlap (asked only after `overlaps` said yes).
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

/// As above for the kinds that the two hold; B before A where the table has the other order.
Contact contact(const Primitive& a, const Primitive& b);
Contact contact(const Primitive& a, const Triangle& b);

}  // namespace collided::engine
