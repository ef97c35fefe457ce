#pragma once

#include <cmath>

namespace collided::wire_contract {

/// Allowed deviation from 1 of a rotation quaternion's norm: a quaternion of floats that was multiplied a few times
/// passes; a scaled one does not.
inline constexpr double kUnitQuaternionSlack = 1e-6;

inline double quaternion_norm(double w, double x, double y, double z) {
  return std::sqrt(w * w + x * x + y * y + z * z);
}

/// True if the four numbers are a rotation, as checked at every entry of server and client; false for NaN and infinity.
inline bool is_unit_quaternion(double w, double x, double y, double z) {
  return std::abs(quaternion_norm(w, x, y, z) - 1) <= kUnitQuaternionSlack;
}
template <class Quaternion>
bool is_unit_quaternion(const Quaternion& q) {
  return is_unit_quaternion(q.w(), q.x(), q.y(), q.z());
}

}  // namespace collided::wire_contract
