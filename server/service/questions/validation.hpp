#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "server/geometry/pose.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// A pose from seven untrusted numbers: x y z in m, then the quaternion w x y z. All must be finite, and the norm 1
/// within kUnitQuaternionSlack; the quaternion stays as it is, and stands for v -> q v q* / |q|^2.
std::variant<Pose, Refusal> checked_pose(std::span<const double> numbers);

/// The same without a reason, from kPoseNumbers numbers. False leaves `pose` as it was. No allocation.
bool read_pose(const double* numbers, Pose& pose);

/// Whether an untrusted name is 1 to 255 bytes of UTF-8 without control characters: names go into JSON and onto
/// terminals.
bool is_good_name(std::string_view name);

/// The name as it may be printed: in quotes, cut after 80 bytes, '?' for each byte that is_good_name() refuses.
std::string printable(std::string_view name);

}  // namespace collided::engine::service
