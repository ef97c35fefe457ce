#pragma once

#include <limits>
#include <memory>
#include <string>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

inline constexpr long kCannot = -1;

/// One library over one mesh. What it has no call for it answers with kCannot or NaN.
class OverlapPeer {
 public:
  virtual ~OverlapPeer() = default;
  virtual std::string name() const = 0;
  /// Triangles that the set meets; with `any` 1 or 0, and the search may end at the first.
  virtual long sphere(const Vec3&, double, bool) { return kCannot; }
  /// Along the axes.
  virtual long box(const Vec3&, const Vec3&, bool) { return kCannot; }
  virtual double closest_m(const Vec3&) { return std::numeric_limits<double>::quiet_NaN(); }
  /// Counts bodies, not triangles.
  virtual bool only_any() const { return false; }
  double build_s = 0;
};

std::unique_ptr<OverlapPeer> embree_peer(const TriangleMesh& mesh);
std::unique_ptr<OverlapPeer> bullet_peer(const TriangleMesh& mesh);
std::unique_ptr<OverlapPeer> cgal_peer(const TriangleMesh& mesh);
std::unique_ptr<OverlapPeer> fcl_peer(const TriangleMesh& mesh);
std::unique_ptr<OverlapPeer> ode_peer(const TriangleMesh& mesh);

}  // namespace collided::bench
