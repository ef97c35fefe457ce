#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace collided::engine {

/// The engine's only vector types: double, from Eigen.
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

}  // namespace collided::engine
