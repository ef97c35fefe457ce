#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// A line that names the object, group or material of the faces after it.
struct ObjMark {
  enum class Kind { object, group, material };
  Kind kind;
  std::size_t face_index;  // the first face of the chunk after the line
  std::string name;
};

/// A run of whole lines of an OBJ file, which is parsed independently of the others. Corners refer to vertices of the
/// whole file. After parsing, the text is no longer needed.
struct ObjChunk {
  std::string_view text;
  std::int64_t lines_before = 0;
  std::vector<Vec3> vertices{};
  std::vector<std::uint32_t> corners{};  // vertex numbers in the file from 0; relative if is_relative
  std::vector<bool> is_relative{};       // by corner: it counts back from the preceding vertices; empty: none does
  std::vector<std::uint32_t> face_corner_counts{};
  std::vector<std::uint32_t> face_lines{};  // by face: its line in the chunk, for errors
  std::vector<ObjMark> marks{};
  std::uint64_t triangle_count = 0;
  // Counts of ignored content, for the report.
  std::uint64_t point_lines = 0;
  std::uint64_t curve_lines = 0;
  std::uint64_t weighted_vertices = 0;
  std::uint64_t short_faces = 0;  // with fewer than three corners
  std::uint64_t unknown_lines = 0;
  std::int64_t first_unknown_line = 0;  // its number in the file, from 1

  /// The vertex that a corner refers to, by its number in the file from 0; negative if that is before the first one.
  /// vertices_before  number of vertices in the chunks before this one
  std::int64_t vertex_of(std::size_t corner, std::int64_t vertices_before) const {
    if (is_relative.empty() || !is_relative[corner]) return corners[corner];
    return vertices_before + static_cast<std::int32_t>(corners[corner]);
  }
};

/// Most bytes of a chunk, so that 32 bits suffice to number its lines and vertices.
inline constexpr std::size_t kMaxObjChunkBytes = std::size_t{1} << 31;

/// Cuts a file into chunks on request, one after the other, so that no more of the file need be in memory than is being
/// parsed. Cuts are at line ends, never inside a line that a backslash continues.
///
/// threads  one at a time
class ObjSplitter {
 public:
  /// The reading must outlive this.
  explicit ObjSplitter(const Reading& reading) : reading_(reading), text_(reading.begin(), reading.bytes.size()) {}

  std::size_t chunk_count_at_most() const { return text_.size() / kChunkBytes + 1; }
  /// The next chunk; one without text if there are no more.
  /// throws  LoadError for a line of more than kMaxObjChunkBytes, and if the rest of the file cannot be read
  ObjChunk next();

 private:
  static constexpr std::size_t kChunkBytes = std::size_t{2} << 20;

  void fetch(std::size_t end);
  std::size_t line_end_from(std::size_t place);

  const Reading& reading_;
  std::string_view text_;
  std::size_t fetched_ = 0;  // bytes of the file that are in memory
  std::size_t begin_ = 0;    // of the next chunk
  std::int64_t lines_before_ = 0;
};

/// Parses a chunk and returns the memory of its text.
/// threads  any, for different chunks
void parse_obj_chunk(const Reading& reading, ObjChunk& chunk);

}  // namespace collided::engine
