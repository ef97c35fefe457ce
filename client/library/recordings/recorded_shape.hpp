#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collided/shown_objects.hpp"

namespace collided::client {

/// A shape for viewers, in the server's form: primitives as parts, and surfaces.
struct DrawnShape {
  Shape parts;
  std::vector<SurfaceRun> runs;
};

/// Decodes a shape of a recorded definition or command (table Shape of scene.fbs) from untrusted bytes. Throws
/// std::runtime_error if it is invalid.
///
/// scale         factors in addition to the shape's own
/// first_number  number of its first surface; others follow
/// memory        a small multiple of the bytes, at most kMostDrawnParts parts
/// difference    a hull's triangles are computed in doubles, while the server's are exact
DrawnShape drawn_shape(std::span<const std::uint8_t> bytes, const Vec3& scale, std::uint64_t first_number);

/// Parts of one shape.
inline constexpr std::size_t kMostDrawnParts = 1'000'000;

}  // namespace collided::client
