#pragma once

#include <cstddef>
#include <cstdint>

namespace collided::engine {

/// Vertices are numbered in 32 bits.
inline constexpr std::uint64_t kMaxVertices = 0xffffffff;

/// Bytes of a name, so that it fits every table and topic that carries it.
inline constexpr std::size_t kMaxNameBytes = 255;

/// Corners of one polygon that touches or crosses itself: what is left then is quadratic, and this many take one to two
/// seconds. Others have no limit.
inline constexpr std::size_t kMaxConcaveCorners = 20'000;

/// Triangles of one curved surface.
inline constexpr std::uint64_t kMaxTessellationTriangles = 20'000'000;

/// Places at which one polygon is split because it crosses itself; one that crosses more often is cut by ears alone.
inline constexpr std::size_t kMaxCrossings = 100;

/// Distance of a polygon's corners from its plane, in parts of its size, from which on it is said to be bent: more than
/// the seven digits of most files explain.
inline constexpr double kFlatEnough = 1e-6;

/// Each is a sphere of some 140 bytes with its place in an index.
inline constexpr std::uint64_t kMaxCloudPoints = 1'000'000;

/// Bytes of a file's JSON text: its values take up to ten times as much while they are read.
inline constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 29;

/// Borders that are weighed in one search for T-vertices and cracks: about five seconds. Soups of long triangles, where
/// every border is near every point, reach it, and are told that not all was looked at.
inline constexpr std::uint64_t kMaxSeamTests = 300'000'000;

}  // namespace collided::engine
