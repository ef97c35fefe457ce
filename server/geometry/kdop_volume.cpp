// The volume of a k-DOP, for tables.

#include <cmath>
#include <limits>
#include <vector>

#include "server/geometry/bounding_volumes.hpp"

namespace collided::engine {
namespace {

struct HalfSpaceOf {
  Vec3 normal;  // unit
  double reach;
};

using Face = std::vector<Vec3>;

/// The part of a flat convex face that lies behind the plane.
Face behind(const Face& face, const HalfSpaceOf& plane) {
  Face kept;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3& from = face[i];
    const Vec3& to = face[(i + 1) % face.size()];
    const double of_from = plane.normal.dot(from) - plane.reach;
    const double of_to = plane.normal.dot(to) - plane.reach;
    if (of_from <= 0) kept.push_back(from);
    if ((of_from < 0 && of_to > 0) || (of_from > 0 && of_to < 0))
      kept.push_back(from + of_from / (of_from - of_to) * (to - from));
  }
  return kept;
}

/// A square in the plane that extends beyond everything within `size` of the origin.
Face whole_face(const HalfSpaceOf& plane, double size) {
  const Vec3 u = plane.normal.unitOrthogonal() * size;
  const Vec3 v = plane.normal.cross(u);
  const Vec3 middle = plane.normal * plane.reach;
  return {middle + u + v, middle - u + v, middle - u - v, middle + u - v};
}

double area(const Face& face) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 2; i < face.size(); ++i) twice += (face[i - 1] - face[0]).cross(face[i] - face[0]);
  return twice.norm() / 2;
}

}  // namespace

/// The sum of pyramids over the faces from a point inside: height times area, over 3.
double volume(const Kdop& kdop) {
  if (kdop.normals.size() < 3) return std::numeric_limits<double>::infinity();
  Mat3 rows;
  Vec3 middle;
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(kdop.low[k] <= kdop.high[k])) return 0;
    rows.row(i) = kdop.normals[k];
    middle[i] = kdop.low[k] / 2 + kdop.high[k] / 2;
    size += (kdop.high[k] - kdop.low[k]) / kdop.normals[k].norm();
  }
  const Vec3 center = rows.inverse() * middle;
  const double reach = 4 * size * rows.inverse().norm() * rows.norm();
  std::vector<HalfSpaceOf> planes;
  for (std::size_t i = 0; i < kdop.normals.size(); ++i) {
    const double length = kdop.normals[i].norm();
    const Vec3 normal = kdop.normals[i] / length;
    const double at_center = normal.dot(center);
    planes.push_back({normal, kdop.high[i] / length - at_center});
    planes.push_back({-normal, at_center - kdop.low[i] / length});
  }
  double sum = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    Face face = whole_face(planes[i], reach);
    for (std::size_t k = 0; k < planes.size() && !face.empty(); ++k) {
      if (k != i) face = behind(face, planes[k]);
    }
    sum += planes[i].reach * area(face);
  }
  return sum / 3;
}

}  // namespace collided::engine
