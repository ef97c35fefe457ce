#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"

namespace collided::bench {
using namespace engine;

using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// One library over two meshes, its indexes built beforehand.
class MeshPairPeer {
 public:
  virtual ~MeshPairPeer() = default;
  virtual std::string name() const = 0;
  /// The second mesh goes to this pose; what a library must rebuild for that is part of its time.
  virtual void move(const Frame& frame) = 0;
  /// Pairs of triangles that it says meet, in any order, some twice.
  virtual void all_pairs(TrianglePairs& out) = 0;
  virtual bool any() = 0;
  /// How many contacts it tells, each with point, normal and depth; nothing: it tells none.
  virtual std::optional<std::size_t> contacts() { return std::nullopt; }
  /// Of the meshes, which do not touch, with the nearest points; nothing: it cannot.
  virtual std::optional<double> distance_m() { return std::nullopt; }
};

std::unique_ptr<MeshPairPeer> fcl_pair_peer(const TriangleMesh& a, const TriangleMesh& b);
std::unique_ptr<MeshPairPeer> cgal_pair_peer(const TriangleMesh& a, const TriangleMesh& b);
std::unique_ptr<MeshPairPeer> ode_pair_peer(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace collided::bench
