#pragma once

#include "server/geometry/shapes.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// Position, metres, and rotation of a body in the world (X_WB): v -> q v q* / |q|^2, so that the quaternion is used as
/// given; validation keeps its norm within 1e-6 of 1.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();
};

/// A pose prepared for placing points: the rotation matrix in double, by one documented sequence of operations.
struct Frame {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();
};

/// Divides the quaternion by its norm, in double, unless that is 1 up to its own rounding.
Frame frame_of(const Pose& pose);

/// The pose of b in the world, if a is the pose in the world and b is given in a's frame. Rounded in double.
Pose composed(const Pose& a, const Pose& b);
Pose inverse(const Pose& pose);

/// R p + t, each row as ((r0 p0 + r1 p1) + r2 p2) + t in double. This rounding is part of the exact input: the result
/// is the world point, and later decisions are exact about it.
Vec3 place(const Frame& frame, const Vec3& point);

Sphere place(const Frame& frame, const Sphere& sphere);
/// The axes are rotated and not normalised again.
Box place(const Frame& frame, const Box& box);
Capsule place(const Frame& frame, const Capsule& capsule);
Cylinder place(const Frame& frame, const Cylinder& cylinder);
Cone place(const Frame& frame, const Cone& cone);
/// The axes are rotated like those of a box.
Ellipsoid place(const Frame& frame, const Ellipsoid& ellipsoid);
/// Takes a hull in its own frame, as in objects: a placed hull cannot be placed again.
Hull place(const Frame& frame, const Hull& hull);
/// The normal is rotated and rounded like the axes of a box.
HalfSpace place(const Frame& frame, const HalfSpace& half_space);
/// A placed hull's vertex, in world coordinates.
Vec3 vertex_of(const Hull& hull, std::size_t number);
Triangle place(const Frame& frame, const Triangle& triangle);
Primitive place(const Frame& frame, const Primitive& primitive);

}  // namespace collided::engine
