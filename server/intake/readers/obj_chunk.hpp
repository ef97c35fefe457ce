#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// A line that names what the faces after it belong to.
struct ObjMark {
  enum class Kind { object, group, material };
  Kind kind;
  std::size_t face_index;  // the first face of the chunk after the line
  std::string name;
};

/// A run of whole lines of an OBJ file, taken in by itself: vertex numbers are still those of the file. Once it is
/// parsed, nothing here needs the text any more.
struct ObjChunk {
  std::string_view text;
  std::int64_t lines_before = 0;
  std::vector<Vec3> vertices{};
  std::vector<std::uint32_t> corners{};  // as is_relative says
  std::vector<bool> is_relative{};       // of each corner; empty: none is
  std::vector<std::uint32_t> face_corner_counts{};
  std::vector<std::uint32_t> face_lines{};  // where a face is in the chunk, for complaints
  std::vector<ObjMark> marks{};
  std::uint64_t triangle_count = 0;
  std::uint64_t point_lines = 0;
  std::uint64_t curve_lines = 0;
  std::uint64_t weighted_vertices = 0;
  std::uint64_t short_faces = 0;
  std::uint64_t unknown_lines = 0;
  std::int64_t first_unknown_line = 0;  // of the file, from 1

  /// The vertex, in the file's numbers from 0, that a corner means; below 0 if it is before the first one.
  /// vertices_before  in the chunks before this one
  std::int64_t vertex_of(std::size_t corner, std::int64_t vertices_before) const {
    if (is_relative.empty() || !is_relative[corner]) return corners[corner];
    return vertices_before + static_cast<std::int32_t>(corners[corner]);
  }
};

/// Bytes a chunk may have, so that 32 bits number its lines and vertices.
inline constexpr std::size_t kMaxObjChunkBytes = std::size_t{1} << 31;

/// Cuts a file into chunks at line ends, never inside a line that a backslash continues, one after the other as they are
/// asked for: no more of the file need be there than what is being parsed.
///
/// threads  one at a time
class ObjSplitter {
 public:
  /// The reading must live as long as this.
  explicit ObjSplitter(const Reading& reading) : reading_(reading), text_(reading.begin(), reading.bytes.size()) {}

  std::size_t chunk_count_at_most() const { return text_.size() / kChunkBytes + 1; }
  /// Without text: there are no more.
  /// throws  LoadError for a line of more than kMaxObjChunkBytes, and where the file cannot be read on
  ObjChunk next();

 private:
  static constexpr std::size_t kChunkBytes = std::size_t{2} << 20;

  void fetch(std::size_t end);
  std::size_t line_end_from(std::size_t place);

  const Reading& reading_;
  std::string_view text_;
  std::size_t fetched_ = 0;  // bytes that are there
  std::size_t begin_ = 0;    // of the next chunk
  std::int64_t lines_before_ = 0;
};

/// Takes a chunk in and gives its text back.
void parse_obj_chunk(const Reading& reading, ObjChunk& chunk);

}  // namespace collided::engine
