#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Vectors, rotations and poses. Everywhere in this library: metres, right-handed frames, unit quaternions; where a
/// quaternion is written as numbers, w comes first. Unless stated otherwise, points and directions are in world
/// coordinates.
#pragma GCC visibility push(default)

namespace collided {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

/// Where an object's frame is: x_world = rotation * x_object + position.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();  // norm within 1e-6 of 1, else the call that takes it refuses it
};

/// The triangle number of something that is not a triangle, such as a sphere.
inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

}  // namespace collided

#pragma GCC visibility pop
