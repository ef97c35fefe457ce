#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace collided::engine {

/// The engine's only vector types: double, from Eigen.
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Not aligned to 16 bytes, which would pad a pose of seven doubles to eight.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

}  // namespace collided::engine
