#include "server/intake/readers/vertex_buffer.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "server/intake/limits.hpp"

namespace collided::engine {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie");

/// The flaw of a buffer; thrown and caught in this file.
struct VertexFlaw {
  std::string what;
};

template <class Number>
Number read_at(std::span<const std::byte> bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof(Number));
  return number;
}

struct BufferPiece {
  const char* name;
  std::size_t corner_count;
  std::size_t fewest_corners;
};

BufferPiece piece_of(BufferKind kind) {
  switch (kind) {
    case BufferKind::points: return {"point", 1, 1};
    case BufferKind::segments: return {"segment", 2, 2};
    case BufferKind::polyline: return {"segment", 1, 2};
    case BufferKind::triangles: return {"triangle", 3, 3};
    case BufferKind::fan:
    case BufferKind::strip: return {"triangle", 1, 3};
  }
  throw VertexFlaw{fmt::format("kind {}, allowed are 0 to 5", static_cast<int>(kind))};
}

/// The number of the first primitive that uses corner i of the sequence.
std::size_t piece_with(BufferKind kind, std::size_t i) {
  const BufferPiece piece = piece_of(kind);
  if (piece.corner_count > 1) return i / piece.corner_count;
  return i < piece.fewest_corners ? 0 : i - piece.fewest_corners + 1;
}

void check_layout(const VertexBuffer& buffer) {
  const std::size_t position_bytes = buffer.is_double ? 24 : 12;
  if (buffer.stride_bytes < position_bytes || buffer.offset_bytes > buffer.stride_bytes - position_bytes) {
    throw VertexFlaw{fmt::format("stride {} and offset {} bytes, a position of {} bytes does not fit into a vertex",
                                 buffer.stride_bytes, buffer.offset_bytes, position_bytes)};
  }
  const std::size_t rest = buffer.vertices.size() % buffer.stride_bytes;
  if (rest != 0 && rest < buffer.offset_bytes + position_bytes) {
    throw VertexFlaw{fmt::format("{} bytes of vertices, the last one breaks off after {} of {}", buffer.vertices.size(),
                                 rest, buffer.stride_bytes)};
  }
  if (buffer.index_bytes != 0 && buffer.index_bytes != 2 && buffer.index_bytes != 4) {
    throw VertexFlaw{fmt::format("indices of {} bytes, allowed are 2 and 4, and 0 for none", buffer.index_bytes)};
  }
  if (buffer.index_bytes == 0 ? !buffer.indices.empty() : buffer.indices.size() % buffer.index_bytes != 0) {
    throw VertexFlaw{fmt::format("{} bytes of indices of {} bytes each", buffer.indices.size(), buffer.index_bytes)};
  }
}

std::vector<Vec3> read_vertices(const VertexBuffer& buffer) {
  const std::size_t count = (buffer.vertices.size() + buffer.stride_bytes - 1) / buffer.stride_bytes;
  if (count > kMaxVertices) throw VertexFlaw{fmt::format("{} vertices, limit {}", count, kMaxVertices)};
  std::vector<Vec3> vertices(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * buffer.stride_bytes + buffer.offset_bytes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      vertices[i][static_cast<int>(axis)] = buffer.is_double
                                                ? read_at<double>(buffer.vertices, at + 8 * axis)
                                                : static_cast<double>(read_at<float>(buffer.vertices, at + 4 * axis));
    }
    const Vec3& v = vertices[i];
    if (!v.allFinite()) throw VertexFlaw{fmt::format("vertex {} is ({}, {}, {})", i, v[0], v[1], v[2])};
  }
  return vertices;
}

/// The vertex numbers in the order in which they form primitives.
std::vector<std::uint32_t> read_sequence(const VertexBuffer& buffer, std::size_t vertex_count) {
  const BufferPiece piece = piece_of(buffer.kind);
  const std::size_t count = buffer.index_bytes == 0 ? vertex_count : buffer.indices.size() / buffer.index_bytes;
  if (count < piece.fewest_corners || count % piece.corner_count != 0) {
    throw VertexFlaw{fmt::format("{} corners, a {} takes {}{}", count, piece.name, piece.fewest_corners,
                                 piece.corner_count > 1 ? ", and the last one is not whole" : "")};
  }
  std::vector<std::uint32_t> sequence(count);
  for (std::size_t i = 0; i < count; ++i) {
    sequence[i] = buffer.index_bytes == 0   ? static_cast<std::uint32_t>(i)
                  : buffer.index_bytes == 2 ? read_at<std::uint16_t>(buffer.indices, 2 * i)
                                            : read_at<std::uint32_t>(buffer.indices, 4 * i);
    if (sequence[i] >= vertex_count) {
      throw VertexFlaw{fmt::format("{} {}: index {} is vertex {} of {}", piece.name, piece_with(buffer.kind, i), i,
                                   sequence[i], vertex_count)};
    }
  }
  return sequence;
}

void join(BufferKind kind, const std::vector<std::uint32_t>& sequence, DecodedBuffer& decoded) {
  const std::size_t count = sequence.size();
  std::vector<TriangleCorners>& triangles = decoded.mesh.triangles;
  switch (kind) {
    case BufferKind::points: decoded.points = sequence; return;
    case BufferKind::segments:
      for (std::size_t i = 0; i < count; i += 2) decoded.segments.push_back({sequence[i], sequence[i + 1]});
      return;
    case BufferKind::polyline:
      for (std::size_t i = 1; i < count; ++i) decoded.segments.push_back({sequence[i - 1], sequence[i]});
      return;
    case BufferKind::triangles:
      for (std::size_t i = 0; i < count; i += 3) triangles.push_back({sequence[i], sequence[i + 1], sequence[i + 2]});
      return;
    case BufferKind::fan:
      for (std::size_t i = 2; i < count; ++i) triangles.push_back({sequence[0], sequence[i - 1], sequence[i]});
      return;
    case BufferKind::strip:
      for (std::size_t i = 0; i + 2 < count; ++i) {
        if (const TriangleCorners corners = strip_triangle(sequence, i); !is_collapsed(corners))
          triangles.push_back(corners);
      }
      return;
  }
}

}  // namespace

std::variant<DecodedBuffer, std::string> decode_buffer(const VertexBuffer& buffer) {
  try {
    piece_of(buffer.kind);
    check_layout(buffer);
    DecodedBuffer decoded;
    decoded.mesh.vertices = read_vertices(buffer);
    join(buffer.kind, read_sequence(buffer, decoded.mesh.vertices.size()), decoded);
    return decoded;
  } catch (const VertexFlaw& flaw) { return flaw.what; }
}

std::variant<Shape, std::string> shape_of_buffer(const VertexBuffer& buffer, double radius_m) {
  if (!(radius_m >= 0 && std::isfinite(radius_m)))
    return fmt::format("radius {} m, allowed are finite sizes of 0 and more", radius_m);
  std::variant<DecodedBuffer, std::string> decoded = decode_buffer(buffer);
  if (const auto* flaw = std::get_if<std::string>(&decoded)) return *flaw;
  auto& parts = std::get<DecodedBuffer>(decoded);
  const std::vector<Vec3>& v = parts.mesh.vertices;
  Shape shape;
  for (const std::uint32_t point : parts.points) shape.primitives.push_back(Sphere{v[point], radius_m});
  for (const auto& [a, b] : parts.segments) shape.primitives.push_back(Capsule{v[a], v[b], radius_m});
  if (parts.points.empty() && parts.segments.empty()) {
    if (parts.mesh.triangles.empty()) return "a strip that only steers, without a triangle";
    shape.mesh = std::make_shared<const TriangleMesh>(std::move(parts.mesh));
  }
  return shape;
}

}  // namespace collided::engine
