#pragma once

#include <cstddef>
#include <cstdint>

// Limits of loading. Beyond a limit a file is refused or the report names what was left undone.
namespace collided::engine {

/// Vertices of a mesh: their numbers have 32 bits.
inline constexpr std::uint64_t kMaxVertices = 0xffffffff;

/// Bytes of a name, so that it fits every table and topic with names.
inline constexpr std::size_t kMaxNameBytes = 255;

/// Corners of one polygon that touches or crosses itself: only a quadratic method can cut it, and this many corners
/// take one to two seconds. Other polygons have no limit.
inline constexpr std::size_t kMaxConcaveCorners = 20'000;

/// Triangles of one curved surface.
inline constexpr std::uint64_t kMaxTessellationTriangles = 20'000'000;

/// Crossings at which one polygon is split; a polygon that crosses itself more often is only cut by clipping ears.
inline constexpr std::size_t kMaxCrossings = 100;

/// A polygon is reported as bent if a corner is farther from its plane than this fraction of its size: more than
/// rounding to the seven digits of most files explains.
inline constexpr double kFlatEnough = 1e-6;

/// Points of a cloud: each becomes a sphere, which takes some 140 bytes with its place in an index.
inline constexpr std::uint64_t kMaxCloudPoints = 1'000'000;

/// Bytes of a file's JSON text: its values take up to ten times as much memory while they are read.
inline constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 29;

/// Tests of a point against a border edge in one search for T-vertices and cracks: about five seconds. Soups of long
/// triangles, in which every edge is near every point, reach the limit; the report then states that not all was
/// examined.
inline constexpr std::uint64_t kMaxSeamTests = 300'000'000;

}  // namespace collided::engine
