#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Metres, right-handed; quaternions w first.
#pragma GCC visibility push(default)

namespace collided {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

struct Pose {
  Vec3 position = Vec3::Zero();
  Quat rotation = Quat::Identity();
};

/// Of what is no triangle.
inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

}  // namespace collided

#pragma GCC visibility pop
