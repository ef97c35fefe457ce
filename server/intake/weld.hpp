#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// For each vertex the first vertex with equal coordinates (itself where there is none before it). Equal means ==, so
/// 0 and -0 are one; nothing that is merely near is joined.
/// cost      one hash look-up a vertex
std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices);

/// Takes vertices one after the other and keeps each place once: for formats in which every triangle repeats its
/// corners, whose vertices would else be held six times.
/// cost      about 20 ns a vertex while the kept ones fit the cache
class Welder {
 public:
  /// kept            where the vertices go; empty, and nobody else's while this lives
  /// expected_count  how many will be kept; more only take longer
  explicit Welder(std::vector<Vec3>& kept, std::size_t expected_count = 0);

  /// The number of the kept vertex with these coordinates, which is this one where it is the first.
  std::uint32_t number_of(const Vec3& vertex);
  /// The same for many at once, whose places in the table are fetched ahead. At most kBatch.
  static constexpr std::size_t kBatch = 48;
  void number(std::span<const Vec3> vertices, std::uint32_t* numbers);

 private:
  std::uint32_t find_or_keep(const Vec3& vertex, std::uint64_t hash);
  void grow();

  std::vector<Vec3>& kept_;
  std::vector<std::uint32_t> slots_;  // an open table, at most half full
};

/// Joins vertices with equal coordinates and drops none that a triangle uses; the triangles keep their points.
void weld_equal_vertices(TriangleMesh& mesh);

/// The triangles, ascending, whose three points an earlier triangle has as well, in any order.
/// first_equal  as first_equal_vertices gives it
std::vector<std::uint32_t> duplicate_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal);

}  // namespace collided::engine
