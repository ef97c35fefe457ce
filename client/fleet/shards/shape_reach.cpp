#include "client/fleet/shards/shape_reach.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>

namespace collided::client {
namespace {

constexpr double kReachSlack = 1 + 0x1p-40;  // a thousand times the roundings of a length

double farthest(std::span<const Vec3> points) {
  double reach_m = 0;
  for (const Vec3& point : points) reach_m = std::max(reach_m, point.stableNorm());
  return reach_m;
}

struct PartReach {
  double operator()(const SphereShape& sphere) const { return sphere.center.stableNorm() + sphere.radius_m; }
  double operator()(const BoxShape& box) const { return box.center.stableNorm() + box.half_m.stableNorm(); }
  double operator()(const CapsuleShape& capsule) const {
    return std::max(capsule.a.stableNorm(), capsule.b.stableNorm()) + capsule.radius_m;
  }
  double operator()(const CylinderShape& cylinder) const {
    return std::max(cylinder.a.stableNorm(), cylinder.b.stableNorm()) + cylinder.radius_m;
  }
  double operator()(const ConeShape& cone) const {
    return std::max(cone.apex.stableNorm(), cone.base.stableNorm() + cone.radius_m);
  }
  double operator()(const EllipsoidShape& ellipsoid) const {
    return ellipsoid.center.stableNorm() + ellipsoid.half_m.maxCoeff();
  }
  double operator()(const HullShape& hull) const { return farthest(hull.points); }
  double operator()(const MeshShape& mesh) const { return farthest(mesh.vertices); }
  double operator()(const HalfSpaceShape&) const { return std::numeric_limits<double>::infinity(); }
  double operator()(const HeightFieldShape& field) const {
    double height_m = 0;
    for (const double height : field.heights_m) height_m = std::max(height_m, std::abs(height));
    const double rows = field.columns > 0 ? static_cast<double>(field.heights_m.size()) / field.columns : 0;
    return Vec3(field.columns * field.spacing_x_m, rows * field.spacing_y_m, height_m).stableNorm();
  }
  double operator()(const CloudShape& cloud) const { return farthest(cloud.points) + cloud.radius_m; }
  double operator()(const PolylineShape& line) const { return farthest(line.points) + line.radius_m; }
  double operator()(const VoxelShape& voxels) const {
    Vec3 reach = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      const double low = voxels.low[at];
      reach[axis] = std::max(std::abs(low), std::abs(low + voxels.size[at])) * voxels.cell_m;
    }
    return reach.stableNorm();
  }
};

}  // namespace

double reach_of(const Shape& shape, const Vec3& scale) {
  double reach_m = 0;
  for (const ShapePart& part : shape) reach_m = std::max(reach_m, std::visit(PartReach{}, part));
  return reach_m * scale.cwiseAbs().maxCoeff() * kReachSlack;
}

}  // namespace collided::client
