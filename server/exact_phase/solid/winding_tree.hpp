#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/bounded.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Where a point is by the winding number of a mesh that need not close: in where that is above 1/2, and then within the
/// mesh's bounds. Undecided where the bound on the number leaves that open, as on the surface itself, across which the
/// number jumps.
enum class WindingSide : std::uint8_t { out, in, undecided };

/// The generalised winding number of a mesh about points: the sum of the solid angles under which its triangles are
/// seen, with the sign of their facing, over 4 pi. In a closed mesh it is how often that goes around the point; where a
/// mesh has holes it varies smoothly across them.
///
/// threads  immutable; any number may ask it
/// cost     a copy of the triangles and some 40 bytes more for each
/// source   Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding numbers", ACM
///          Transactions on Graphics 32, 2013; far triangles together by a Taylor series: Barill, Dickson, Schmidt,
///          Levin, Jacobson, "Fast winding numbers for soups and clouds", ACM Transactions on Graphics 37, 2018, here
///          with a bound on what the series leaves out
class WindingTree {
 public:
  explicit WindingTree(const TriangleMesh& mesh);

  /// The number with a proved bound.
  ///
  /// off_m   the true point lies within this of the given one, along each axis
  /// widest  triangles are taken together where their radius is at most this share of their distance: in [0, 1/2]
  /// nodes   grows by the clusters and triangles looked at
  Bounded around(const Vec3& point, double off_m, double widest, std::uint32_t& nodes) const;
  /// From coarse to fine, until the bound decides or does not get better.
  WindingSide side(const Vec3& point, double off_m, std::uint32_t& nodes) const;

  /// The same from every triangle on its own.
  WindingSide side_by_sum(const Vec3& point, double off_m) const;

  std::uint64_t bytes() const {
    return clusters_.size() * sizeof(WindingCluster) + triangles_.size() * sizeof(Triangle);
  }

 private:
  /// Triangles that are near each other, as they are seen from afar. Integrals over their surface, of the unit normal n
  /// and the place x.
  struct WindingCluster {
    Vec3 centre = Vec3::Zero();
    double radius = 0;           // at least
    double area = 0;             // at least
    double spread = 0;           // at least the integral of |x - centre|^2
    Vec3 normal = Vec3::Zero();  // of n
    Mat3 moment = Mat3::Zero();  // of n (x - centre)^T
    double normal_error = 0;     // summed over the coordinates
    double moment_error = 0;
    std::uint32_t first = 0;  // of its triangles
    std::uint32_t count = 0;
    std::uint32_t other = 0;  // its second half; the first one follows it; 0: it is not divided
  };

  /// Whether the number says on which side the point is; `in` only where it is surely within the bounds.
  WindingSide side_of(const Bounded& number, const Vec3& point, double off_m) const;
  std::uint32_t divide(std::uint32_t first, std::uint32_t count);
  WindingCluster cluster_of(std::uint32_t first, std::uint32_t count) const;
  static Bounded half_solid_angle_from_afar(const WindingCluster& c, const Vec3& to_centre, double moved, double near);

  int exponent_ = 0;  // all lengths are times 2^exponent, so that no product overflows or vanishes
  Aabb bounds_;       // of the mesh, as given
  std::vector<Triangle> triangles_;
  std::vector<WindingCluster> clusters_;
};

}  // namespace collided::engine
