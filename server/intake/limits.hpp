#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace collided {

/// Vertices are numbered in 32 bits.
inline constexpr std::uint64_t kMaxVertices = 0xffffffff;

/// Bytes of a name, so that it fits every table and topic that carries it.
inline constexpr std::size_t kMaxNameBytes = 255;

/// Corners of one concave polygon: ear clipping is quadratic, and this many take one to two seconds.
inline constexpr std::size_t kMaxConcaveCorners = 20'000;

/// | |q| - 1 | that the border takes for a rotation written with seven digits or more; beyond it the four numbers
/// are not a rotation. Dimensionless. At zero, IntakeSceneFile.AQuaternionOfSevenDigitsIsTaken fails.
inline constexpr double kUnitNormSlack = 1e-6;

/// | |q|^2 - 1 | within which a quaternion is left as it is: dividing by the norm leaves at most 2 (3.5 + 0.5)
/// roundings in the square. Dimensionless. At zero, IntakeSceneFile.ComesBackBitForBit fails.
inline constexpr double kNormalizedSlack = 8 * std::numeric_limits<double>::epsilon();

}  // namespace collided
