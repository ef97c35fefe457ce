#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A mesh that need not be in memory.
///
/// threads  one at a time
class MeshSource {
 public:
  virtual ~MeshSource() = default;

  virtual std::uint64_t vertex_count() const = 0;
  virtual std::uint64_t triangle_count() const = 0;
  /// A vertex by its number; cheap if it lies near those of the last calls.
  virtual Vec3 vertex(std::uint32_t number) = 0;
  /// Every triangle in turn, in pieces: visit(number of the first one, corners).
  virtual void visit_triangles(const std::function<void(std::uint32_t, std::span<const TriangleCorners>)>& visit) = 0;

  Triangle triangle(const TriangleCorners& corners) {
    return {vertex(corners[0]), vertex(corners[1]), vertex(corners[2])};
  }
};

/// A mesh in memory.
class HeldMeshSource final : public MeshSource {
 public:
  explicit HeldMeshSource(const TriangleMesh& mesh) : mesh_(mesh) {}

  std::uint64_t vertex_count() const override { return mesh_.vertices.size(); }
  std::uint64_t triangle_count() const override { return mesh_.triangles.size(); }
  Vec3 vertex(std::uint32_t number) override { return mesh_.vertices[number]; }
  void visit_triangles(const std::function<void(std::uint32_t, std::span<const TriangleCorners>)>& visit) override {
    constexpr std::size_t kPiece = 0x10000;
    const std::span all(mesh_.triangles);
    for (std::size_t first = 0; first < all.size(); first += kPiece) {
      visit(static_cast<std::uint32_t>(first), all.subspan(first, std::min(kPiece, all.size() - first)));
    }
  }

 private:
  const TriangleMesh& mesh_;
};

}  // namespace collided::engine
