#pragma once

#include <cstddef>
#include <cstdint>

namespace collided {

/// Vertices are numbered in 32 bits.
inline constexpr std::uint64_t kMaxVertices = 0xffffffff;

/// Bytes of a name, so that it fits every table and topic that carries it.
inline constexpr std::size_t kMaxNameBytes = 255;

/// Corners of one concave polygon: ear clipping is quadratic, and this many take one to two seconds.
inline constexpr std::size_t kMaxConcaveCorners = 20'000;

/// Each is a sphere of some 140 bytes with its place in an index.
inline constexpr std::uint64_t kMaxCloudPoints = 1'000'000;

}  // namespace collided
