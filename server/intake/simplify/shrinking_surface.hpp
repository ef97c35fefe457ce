#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A mesh whose vertices are merged one into another while it is simplified. It tracks the triangles at each vertex,
/// and which vertices may be merged without changing the surface's topology.
///
/// threads  one at a time; the mesh must outlive it
/// Always: no live triangle has two equal corners.
class ShrinkingSurface {
 public:
  explicit ShrinkingSurface(const TriangleMesh& mesh);

  const std::vector<Vec3>& vertices() const { return mesh_.vertices; }
  const std::vector<TriangleCorners>& corners() const { return corners_; }
  bool is_live(std::uint32_t triangle) const { return corners_[triangle][0] != corners_[triangle][1]; }
  std::size_t live_count() const { return live_count_; }
  std::vector<std::uint32_t> live_triangles() const;

  /// Fills `ring` with the live triangles at a vertex.
  void find_ring(std::uint32_t vertex, std::vector<std::uint32_t>& ring);

  /// A vertex that shares an edge with another one.
  struct Neighbour {
    std::uint32_t vertex;
    std::uint32_t triangle_count;  // at that edge
  };
  /// Fills `neighbours` with each vertex that shares a triangle with this one.
  /// ring  of the vertex, from find_ring
  void find_neighbours(std::uint32_t vertex, const std::vector<std::uint32_t>& ring,
                       std::vector<Neighbour>& neighbours) const;

  /// Whether merging a vertex into its neighbour `kept` leaves the surface's pieces, holes and borders as they are: the
  /// two have no common neighbours but the tips of the triangles at their edge, and the piece does not vanish.
  /// ring, neighbours  of the removed vertex
  /// source            link condition: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999
  bool may_merge(const std::vector<std::uint32_t>& ring, const std::vector<Neighbour>& neighbours,
                 const Neighbour& kept);

  /// Replaces `removed` by `kept`; the triangles that had both vanish.
  void merge(std::uint32_t removed, std::uint32_t kept);

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  const TriangleMesh& mesh_;
  std::vector<TriangleCorners> corners_;
  std::vector<std::uint32_t> first_;  // by vertex: 3 * triangle + corner, or kNone
  std::vector<std::uint32_t> next_;   // by 3 * triangle + corner
  std::size_t live_count_ = 0;
  std::vector<std::uint32_t> other_ring_;
  std::vector<Neighbour> other_neighbours_;
};

}  // namespace collided::engine
