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

/// Bytes of a file's JSON text: its values take up to ten times as much while they are read.
inline constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 29;

/// Pairs of edges that are compared to find the bridges of one polygon's holes: a second or two.
inline constexpr std::uint64_t kMaxBridgeTests = 100'000'000;

/// Borders that are weighed in one search for T-vertices and cracks: about five seconds. Soups of long triangles, where
/// every border is near every point, reach it, and are told that not all was looked at.
inline constexpr std::uint64_t kMaxSeamTests = 300'000'000;

}  // namespace collided
