#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "server/geometry/pose.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// x y z qw qx qy qz from outside to a pose: finite, | |q| - 1 | <= kUnitQuaternionSlack, then divided by |q| once.
std::variant<Pose, Refusal> checked_pose(std::span<const double> numbers);

/// The same without the reason, into `pose`; false leaves it as it was.
bool read_pose(const double* numbers, Pose& pose);

/// Names from outside are 1 to 255 bytes of UTF-8 without control characters: they go into JSON and onto terminals.
bool is_good_name(std::string_view name);

/// The name as it may be printed: quoted, cut, '?' for what is_good_name refuses.
std::string printable(std::string_view name);

}  // namespace collided::engine::service
