#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/shape.hpp"

namespace collided::engine {

/// What the vertices of a buffer are joined to.
enum class BufferKind : std::uint8_t {
  points,     // each alone
  segments,   // 0 1, 2 3, ...
  polyline,   // 0 1, 1 2, ...
  triangles,  // 0 1 2, 3 4 5, ...
  fan,        // 0 1 2, 0 2 3, ...: the first one is in all of them
  strip,      // 0 1 2, 2 1 3, 2 3 4, ...: every other one turned round, so that all have one orientation
};

/// A vertex buffer as renderers fill it: little-endian, at any address.
struct VertexBuffer {
  BufferKind kind = BufferKind::triangles;
  bool is_double = false;               // positions are three doubles, else three floats
  std::size_t stride_bytes = 0;         // from vertex to vertex
  std::size_t offset_bytes = 0;         // from a vertex's beginning to its position
  std::span<const std::byte> vertices;  // whole vertices; what follows the last position may be left out
  std::size_t index_bytes = 0;          // of one index: 2 or 4; 0: the vertices as they come
  std::span<const std::byte> indices{};
};

/// A buffer taken in: the vertices in double with their numbers, and what they are joined to.
/// memory  24 bytes a vertex; 12 a triangle, 8 a segment, 4 a point
struct DecodedBuffer {
  TriangleMesh mesh;                                     // triangles, fan, strip; without triangles for the others
  std::vector<std::array<std::uint32_t, 2>> segments{};  // segments, polyline
  std::vector<std::uint32_t> points{};                   // points
};

/// Vertex numbers of triangle i of a strip; it is no triangle where two are equal, which only steers the strip.
inline TriangleCorners strip_triangle(std::span<const std::uint32_t> strip, std::size_t i) {
  const std::size_t odd = i % 2;
  return {strip[i + odd], strip[i + 1 - odd], strip[i + 2]};
}

/// True when two corners are equal.
inline bool is_collapsed(const TriangleCorners& c) { return c[0] == c[1] || c[1] == c[2] || c[2] == c[0]; }

/// The buffer's meaning, or why it has none: what, where, value, limit ("triangle 7: corner 2 is vertex 9 of 8").
///
/// promise  reads nothing outside the spans; memory at most what DecodedBuffer says
std::variant<DecodedBuffer, std::string> decode_buffer(const VertexBuffer& buffer);

/// The buffer as a shape: its triangles as a mesh, its points as balls and its lines as capsules of that radius.
std::variant<Shape, std::string> shape_of_buffer(const VertexBuffer& buffer, double radius_m);

}  // namespace collided::engine
