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

/// What the vertices of a buffer form, by their numbers or, with indices, by the indices' numbers.
enum class BufferKind : std::uint8_t {
  points,     // each by itself
  segments,   // 0 1, 2 3, ...
  polyline,   // 0 1, 1 2, ...
  triangles,  // 0 1 2, 3 4 5, ...
  fan,        // 0 1 2, 0 2 3, ...: the first vertex is in every triangle
  strip,      // 0 1 2, 2 1 3, 2 3 4, ...: every other triangle is turned over, so that all face one way
};

/// A vertex buffer as renderers fill it: little-endian, at any alignment.
struct VertexBuffer {
  BufferKind kind = BufferKind::triangles;
  bool is_double = false;               // positions are three doubles, else three floats
  std::size_t stride_bytes = 0;         // distance between vertices
  std::size_t offset_bytes = 0;         // from a vertex's beginning to its position
  std::span<const std::byte> vertices;  // the last vertex may end after its position
  std::size_t index_bytes = 0;          // bytes of one index: 2 or 4; 0: no indices, vertices are used in order
  std::span<const std::byte> indices{};
};

/// A decoded buffer: the vertices in double, with their numbers in the buffer, and what they form.
/// memory  24 bytes per vertex, 12 per triangle, 8 per segment, 4 per point
struct DecodedBuffer {
  TriangleMesh mesh;  // for triangles, a fan or a strip; for other kinds it has vertices only
  std::vector<std::array<std::uint32_t, 2>> segments{};  // for segments or a polyline
  std::vector<std::uint32_t> points{};                   // for points
};

/// Vertex numbers of triangle i of a strip. If two are equal it does not count as a triangle: such entries only steer
/// the strip.
inline TriangleCorners strip_triangle(std::span<const std::uint32_t> strip, std::size_t i) {
  const std::size_t odd = i % 2;
  return {strip[i + odd], strip[i + 1 - odd], strip[i + 2]};
}

/// Whether two corners are equal.
inline bool is_collapsed(const TriangleCorners& c) { return c[0] == c[1] || c[1] == c[2] || c[2] == c[0]; }

/// Decodes an untrusted buffer, or returns why that is not possible: what, where, value, limit, as in "triangle 7:
/// corner 2 is vertex 9 of 8".
///
/// promise  reads nothing outside the spans; takes no more memory than stated at DecodedBuffer
std::variant<DecodedBuffer, std::string> decode_buffer(const VertexBuffer& buffer);

/// The buffer as a shape, or why that is not possible: triangles become a mesh, points become balls and lines capsules
/// of that radius.
std::variant<Shape, std::string> shape_of_buffer(const VertexBuffer& buffer, double radius_m);

}  // namespace collided::engine
