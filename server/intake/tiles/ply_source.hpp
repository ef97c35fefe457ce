#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/intake/readers/ply_header.hpp"
#include "server/intake/tiles/mesh_source.hpp"

namespace collided::engine {

/// Conversion of a vertex after reading: multiplied by the unit, then turned.
struct VertexPlacing {
  double unit_m = 1;
  bool turns_y_up = false;  // (x, y, z) -> (x, -z, y)
};

/// The mesh of a binary PLY file, which stays on disk: a few pieces of it are in memory at a time. Its triangles and
/// vertices are those of read_ply.
///
/// threads  one at a time
class PlySource final : public MeshSource {
 public:
  /// Reads all rows once. Null if the file must be read as a whole: it is text, its faces are not all triangles, or it
  /// has other lists or tables.
  ///
  /// path     of the file of the reading, which need contain no more than the header
  /// throws   LoadError as read_ply does: a number that is not finite, a vertex that does not exist, a truncated file
  static std::unique_ptr<PlySource> open(const Reading& reading, const PlyHeader& header, const std::string& path,
                                         const VertexPlacing& placing);
  ~PlySource() override;
  PlySource(const PlySource&) = delete;
  PlySource& operator=(const PlySource&) = delete;

  std::uint64_t vertex_count() const override { return vertices_.count; }
  std::uint64_t triangle_count() const override { return faces_.count; }
  Vec3 vertex(std::uint32_t number) override;
  void visit_triangles(const std::function<void(std::uint32_t, std::span<const TriangleCorners>)>& visit) override;

 private:
  /// Rows of one length.
  struct Table {
    std::uint64_t first_byte = 0;
    std::uint64_t count = 0;
    std::size_t row_bytes = 0;
  };
  struct Coordinate {
    std::size_t offset = 0;  // in the row
    PlyType type = PlyType::float32;
  };
  /// Rows of vertices that were read together.
  struct VertexBlock {
    std::uint64_t number = 0;
    std::vector<char> bytes;  // empty: nothing was read
  };

  PlySource(const Reading& reading, const std::string& path, const VertexPlacing& placing);
  bool has_layout(const PlyHeader& header, std::uint64_t file_bytes);
  bool check_rows(const Reading& reading);
  const char* row_of(std::uint32_t number);
  double coordinate(const char* row, const Coordinate& of) const;
  void read(std::uint64_t first_byte, std::span<char> bytes) const;

  std::string name_;
  VertexPlacing placing_;
  int file_ = -1;
  std::endian order_ = std::endian::little;
  Table vertices_;
  Table faces_;
  std::array<Coordinate, 3> axes_{};
  std::size_t count_offset_ = 0;     // offset of the list in a face's row
  std::vector<VertexBlock> blocks_;  // direct-mapped: a block replaces another one at its place
};

}  // namespace collided::engine
