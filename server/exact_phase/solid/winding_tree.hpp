#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/bounded.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Side of a point by the winding number of a possibly open mesh: in if the number is above 1/2 and the point within
/// the mesh's bounds. Undecided if the bound on the number leaves that open, as on the surface itself, where the number
/// jumps.
enum class WindingSide : std::uint8_t { out, in, undecided };

/// The generalised winding number of a mesh at points: the sum of the solid angles of its triangles seen from the
/// point, signed by their facing, over 4 pi. For a closed mesh it is how often the mesh winds around the point; across
/// holes it varies smoothly.
///
/// threads  immutable; any number may query it
/// cost     a copy of the triangles and some 40 bytes more for each
/// source   Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding numbers",
///          ACM Transactions on Graphics 32, 2013; far triangles together by a Taylor series: Barill, Dickson, Schmidt,
///          Levin, Jacobson, "Fast winding numbers for soups and clouds", ACM Transactions on Graphics 37, 2018, here
///          with a bound on what the series leaves out
class WindingTree {
 public:
  explicit WindingTree(const TriangleMesh& mesh);

  /// The number with a proved bound.
  ///
  /// off_m   the true point lies within this of the given one, along each axis
  /// widest  triangles are taken together if their radius is at most this share of their distance: in [0, 1/2]
  /// nodes   grows by the clusters and triangles evaluated
  Bounded around(const Vec3& point, double off_m, double widest, std::uint32_t& nodes) const;
  /// Evaluates from coarse to fine, until the bound decides or stops improving.
  WindingSide side(const Vec3& point, double off_m, std::uint32_t& nodes) const;

  /// Sums every triangle.
  WindingSide side_by_sum(const Vec3& point, double off_m) const;

  std::uint64_t bytes() const {
    return clusters_.size() * sizeof(WindingCluster) + triangles_.size() * sizeof(Triangle);
  }

 private:
  /// Triangles near each other, as seen from afar. Integrals over their surface, of the unit normal n and the position
  /// x.
  struct WindingCluster {
    Vec3 centre = Vec3::Zero();
    double radius = 0;           // upper bound
    double area = 0;             // upper bound
    double spread = 0;           // upper bound on the integral of |x - centre|^2
    Vec3 normal = Vec3::Zero();  // integral of n
    Mat3 moment = Mat3::Zero();  // integral of n (x - centre)^T
    double normal_error = 0;     // summed over the coordinates
    double moment_error = 0;
    std::uint32_t first = 0;  // its first triangle
    std::uint32_t count = 0;
    std::uint32_t other = 0;  // its second half; the first half follows it directly; 0: not divided
  };

  /// Which side the number implies; `in` only if certainly within the bounds.
  WindingSide side_of(const Bounded& number, const Vec3& point, double off_m) const;
  std::uint32_t divide(std::uint32_t first, std::uint32_t count);
  WindingCluster cluster_of(std::uint32_t first, std::uint32_t count) const;
  static Bounded half_solid_angle_from_afar(const WindingCluster& c, const Vec3& to_centre, double moved, double near);

  int exponent_ = 0;  // all lengths are multiplied by 2^exponent, so that no product overflows or underflows
  Aabb bounds_;       // bounds of the mesh as given
  std::vector<Triangle> triangles_;
  std::vector<WindingCluster> clusters_;
};

}  // namespace collided::engine
