#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Vectors, rotations and poses. The whole library uses metres, right-handed frames and unit quaternions; a quaternion
/// written as numbers has w first. Unless stated otherwise, points and directions are in world coordinates.
#pragma GCC visibility push(default)

namespace collided {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

/// The pose of an object's frame in the world: x_world = rotation * x_object + position.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();  // norm within 1e-6 of 1; otherwise calls refuse it
};

/// The triangle number for a part that is not a triangle, such as a sphere.
inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

}  // namespace collided

#pragma GCC visibility pop
