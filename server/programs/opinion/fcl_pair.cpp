#include "server/programs/opinion/fcl_pair.hpp"

#include <fmt/format.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "server/geometry/mesh.hpp"

namespace collided::engine {
namespace {

/// FCL gets no tree over the solids, so each is tested against each; this bounds the time.
constexpr std::size_t kMostSolidPairs = 1'000'000;

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// Thrown for a shape or a pair that FCL does not support.
struct Unsupported {
  std::string why;
};

struct FclPart {
  Geometry geometry;
  fcl::Transform3d at = fcl::Transform3d::Identity();
  bool is_half_space = false;
};

fcl::Transform3d moved_to(const Vec3& position) {
  fcl::Transform3d at = fcl::Transform3d::Identity();
  at.translation() = position;
  return at;
}

/// FCL turns shapes by rotations only, so axes that are not perpendicular are unsupported.
fcl::Transform3d along_axes(const Vec3& center, const Mat3& axes) {
  constexpr double kRotation = 1e-6;
  if (!(axes.transpose() * axes).isApprox(Mat3::Identity(), kRotation))
    throw Unsupported{"axes that are not square to each other"};
  fcl::Transform3d at = moved_to(center);
  at.linear() = axes;
  // A mirrored axis gives the same box or ellipsoid.
  if (axes.determinant() < 0) at.linear().col(0) = -axes.col(0);
  return at;
}

/// FCL's cylinders and similar shapes stand along z with their centre at the origin.
fcl::Transform3d along_segment(const Vec3& from, const Vec3& to) {
  fcl::Transform3d at = moved_to(from / 2 + to / 2);
  if (from != to) at.linear() = Quat::FromTwoVectors(Vec3::UnitZ(), to - from).toRotationMatrix();
  return at;
}

FclPart fcl_part(const Sphere& s) { return {std::make_shared<fcl::Sphered>(s.radius_m), moved_to(s.center)}; }
FclPart fcl_part(const Box& b) { return {std::make_shared<fcl::Boxd>(2 * b.half_m), along_axes(b.center, b.axes)}; }
FclPart fcl_part(const Capsule& c) {
  return {std::make_shared<fcl::Capsuled>(c.radius_m, (c.b - c.a).norm()), along_segment(c.a, c.b)};
}
FclPart fcl_part(const Cylinder& c) {
  return {std::make_shared<fcl::Cylinderd>(c.radius_m, (c.b - c.a).norm()), along_segment(c.a, c.b)};
}
FclPart fcl_part(const Cone& c) {
  return {std::make_shared<fcl::Coned>(c.radius_m, (c.apex - c.base).norm()), along_segment(c.base, c.apex)};
}
FclPart fcl_part(const Ellipsoid& e) {
  return {std::make_shared<fcl::Ellipsoidd>(e.half_m), along_axes(e.center, e.axes)};
}
FclPart fcl_part(const HalfSpace& h) {
  const Vec3 normal = h.normal.normalized();
  return {std::make_shared<fcl::Halfspaced>(normal, normal.dot(h.point)), fcl::Transform3d::Identity(), true};
}
FclPart fcl_part(const Hull& hull) {
  const auto vertices = std::make_shared<const std::vector<Vec3>>(hull.mesh->vertices);
  auto faces = std::make_shared<std::vector<int>>();
  for (const TriangleCorners& face : hull.mesh->triangles) {
    faces->push_back(3);
    for (const std::uint32_t corner : face) faces->push_back(static_cast<int>(corner));
  }
  const auto face_count = static_cast<int>(hull.mesh->triangles.size());
  return {std::make_shared<fcl::Convexd>(vertices, face_count, faces)};
}

FclPart fcl_mesh(const std::vector<const Triangle*>& triangles) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(3 * triangles.size()));
  for (const Triangle* t : triangles) model->addTriangle(t->a, t->b, t->c);
  model->endModel();
  return {model};
}

/// One FCL shape for each primitive, and one for all triangles together.
std::vector<FclPart> fcl_parts(const std::vector<ConvexPart>& parts) {
  std::vector<FclPart> all;
  std::vector<const Triangle*> triangles;
  for (const ConvexPart& part : parts) {
    if (const auto* triangle = std::get_if<Triangle>(&part)) triangles.push_back(triangle);
    else all.push_back(std::visit([](const auto& shape) { return fcl_part(shape); }, std::get<Primitive>(part)));
  }
  if (!triangles.empty()) all.push_back(fcl_mesh(triangles));
  for (FclPart& part : all) part.geometry->computeLocalAABB();
  return all;
}

bool touch(const FclPart& a, const FclPart& b) {
  if (a.is_half_space && b.is_half_space) throw Unsupported{"two half-spaces"};
  const fcl::CollisionRequestd request;  // yes or no, without contacts
  fcl::CollisionResultd result;
  return fcl::collide(a.geometry.get(), a.at, b.geometry.get(), b.at, request, result) > 0;
}

double distance(const FclPart& a, const FclPart& b) {
  fcl::DistanceRequestd request;
  request.enable_signed_distance = false;  // with it, FCL's search asserts on boxes in line with each other
  request.distance_tolerance = 1e-10;      // the default, 1e-6, stops the search too early
  fcl::DistanceResultd result;
  return fcl::distance(a.geometry.get(), a.at, b.geometry.get(), b.at, request, result);
}

/// Whether any two parts touch, else their least distance.
std::string answer(const std::vector<FclPart>& a, const std::vector<FclPart>& b) {
  for (const FclPart& x : a) {
    for (const FclPart& y : b) {
      if (touch(x, y)) return "touching";
    }
  }
  double least_m = std::numeric_limits<double>::infinity();
  for (const FclPart& x : a) {
    for (const FclPart& y : b) {
      if (x.is_half_space || y.is_half_space) return "apart - FCL has no distance from a half-space";
      const double here_m = distance(x, y);
      if (!(here_m >= 0)) return "apart - FCL found no nearest points";
      least_m = std::min(least_m, here_m);
    }
  }
  return fmt::format("apart {:.17g}", least_m);
}

}  // namespace

std::string fcl_answer(const OpinionRequest& request) {
  try {
    const std::vector<FclPart> a = fcl_parts(request.a);
    const std::vector<FclPart> b = fcl_parts(request.b);
    if (a.size() * b.size() > kMostSolidPairs) {
      throw Unsupported{
          fmt::format("{} by {} solids; FCL is asked about {} pairs at most", a.size(), b.size(), kMostSolidPairs)};
    }
    return answer(a, b);
  } catch (const Unsupported& unsupported) { return "unsupported " + unsupported.why; }
}

}  // namespace collided::engine
