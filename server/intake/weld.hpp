#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// For each vertex the number of the first vertex with equal coordinates, which may be itself. Equal means ==, so 0 and
/// -0 are equal; vertices that are merely near stay separate.
/// cost      one hash look-up per vertex
std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices);

/// Takes vertices one after the other and keeps one vertex for each place. For formats in which every triangle repeats
/// its corners, whose vertices would otherwise be stored six times.
///
/// threads   one at a time
/// cost      about 20 ns per vertex while the kept ones fit the cache
class Welder {
 public:
  /// kept            where the vertices go; initially empty, and changed only by the welder during its life
  /// expected_count  how many vertices will be kept; more are allowed and only take longer
  explicit Welder(std::vector<Vec3>& kept, std::size_t expected_count = 0);

  /// The number of the kept vertex with these coordinates; the vertex is kept if there is none yet.
  std::uint32_t number_of(const Vec3& vertex);
  /// Numbers for up to kBatch vertices at once: faster, since their places in the table are fetched in advance.
  static constexpr std::size_t kBatch = 48;
  void number(std::span<const Vec3> vertices, std::uint32_t* numbers);

 private:
  std::uint32_t find_or_keep(const Vec3& vertex, std::uint64_t hash);
  void grow();

  std::vector<Vec3>& kept_;
  std::vector<std::uint32_t> slots_;  // hash table with open addressing, at most half full
};

/// Joins vertices with equal coordinates. No triangle's points change.
void weld_equal_vertices(TriangleMesh& mesh);

/// The triangles, in ascending order, that have the same three points as an earlier triangle, in any order.
/// first_equal  from first_equal_vertices
std::vector<std::uint32_t> duplicate_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal);

}  // namespace collided::engine
