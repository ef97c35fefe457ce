#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "server/intake/reading.hpp"

namespace collided {

/// A line that names what the faces after it belong to.
struct ObjMark {
  enum class Kind { object, group, material };
  Kind kind;
  std::size_t face_index;  // the first face of the chunk after the line
  std::string_view name;
};

/// A run of whole lines of an OBJ file, taken in by itself: vertex numbers are still those of the file.
struct ObjChunk {
  std::string_view text;
  std::vector<Vec3> vertices{};
  std::vector<std::int64_t> corners{};  // see kObjRelative
  std::vector<std::uint32_t> face_corner_counts{};
  std::vector<std::uint32_t> face_bytes{};  // where a face begins in the text, for complaints
  std::vector<ObjMark> marks{};
  std::uint64_t triangle_count = 0;
  std::uint64_t point_lines = 0;
  std::uint64_t curve_lines = 0;
  std::uint64_t weighted_vertices = 0;
  std::uint64_t short_faces = 0;
  std::uint64_t unknown_lines = 0;
  const char* first_unknown_line = nullptr;
};

/// Vertex numbers from the file's start are kept as 0, 1, ...; those that count back from the last vertex are kept
/// below zero, as (place in the chunk) - kObjRelative, until it is known how many vertices came before the chunk.
inline constexpr std::int64_t kObjRelative = std::int64_t{1} << 62;

/// Bytes a chunk may have, so that 32 bits say where a face begins.
inline constexpr std::size_t kMaxObjChunkBytes = std::size_t{1} << 31;

/// Splits at line ends, never inside a line that a backslash continues.
std::vector<ObjChunk> split_obj(const Reading& reading);
void parse_obj_chunk(const Reading& reading, ObjChunk& chunk);

}  // namespace collided
