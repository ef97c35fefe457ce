#include "server/world/solids/within.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <type_traits>
#include <variant>

#include "server/geometry/mesh.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

std::vector<std::uint32_t> corner_of_each_piece(const TriangleMesh& mesh, std::uint32_t first, std::uint32_t count) {
  const std::span<const TriangleCorners> triangles = std::span(mesh.triangles).subspan(first, count);
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t most = 0;
  for (const TriangleCorners& corners : triangles) {
    least = std::min({least, corners[0], corners[1], corners[2]});
    most = std::max({most, corners[0], corners[1], corners[2]});
  }
  std::vector<std::uint32_t> found;
  if (triangles.empty()) return found;
  std::vector<std::uint32_t> parent(most - least + 1);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root_of = [&](std::uint32_t corner) {
    std::uint32_t vertex = corner - least;
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  for (const TriangleCorners& corners : triangles) {
    parent[root_of(corners[1])] = root_of(corners[0]);
    parent[root_of(corners[2])] = root_of(corners[0]);
  }
  std::vector<bool> is_known(parent.size());
  for (const TriangleCorners& corners : triangles) {
    const std::uint32_t root = root_of(corners[0]);
    if (!is_known[root]) found.push_back(least + root);
    is_known[root] = true;
  }
  return found;
}

InnerBall inner_ball(const Primitive& own) {
  // Axes are orthonormal up to rounding.
  constexpr double kInside = 1 - kBoundSlack;
  return std::visit(
      [](const auto& part) -> InnerBall {
        using Kind = std::decay_t<decltype(part)>;
        if constexpr (std::is_same_v<Kind, Sphere>) return {part.center, part.radius_m};
        else if constexpr (std::is_same_v<Kind, Box> || std::is_same_v<Kind, Ellipsoid>)
          return {part.center, part.half_m.minCoeff() * kInside};
        else if constexpr (std::is_same_v<Kind, Capsule>) return {part.a, part.radius_m};
        else if constexpr (std::is_same_v<Kind, Cylinder>) return {part.a, 0};
        else if constexpr (std::is_same_v<Kind, Cone>) return {part.base, 0};
        else if constexpr (std::is_same_v<Kind, Hull>) return {vertex_of(part, 0), 0};
        else return {part.point, 0};
      },
      own);
}

std::vector<Vec3> points_of_pieces(const ObjectInfo& info) {
  std::vector<Vec3> points;
  for (const Primitive& own : info.primitives) points.push_back(inner_ball(own).point);
  if (!info.mesh) return points;
  const TriangleMesh& mesh = *info.mesh->mesh;
  for (const std::uint32_t corner : corner_of_each_piece(mesh, 0, static_cast<std::uint32_t>(mesh.triangles.size())))
    points.push_back(mesh.vertices[corner]);
  return points;
}

PiecesWithin pieces_within(const SolidMesh& solid, const Placed& outer, const Placed& inner,
                           std::span<const Vec3> points, Deadline& deadline, WalkCost& cost, std::uint32_t& tests) {
  PiecesWithin found{.some = false, .all = !points.empty()};
  for (const Vec3& own : points) {
    ++tests;
    const bool is_in = !deadline.is_over() && side_of_placed(solid, outer, inner, own, cost).side != SolidSide::out;
    if (is_in && !found.some) found.point = place(inner.frame, own);
    found.some = found.some || is_in;
    found.all = found.all && is_in;
    if (found.some && !found.all) break;
  }
  return found;
}

ContactWithin contact_within(const SolidMesh& solid, const Placed& outer, const Placed& inner, const Vec3& point,
                             WalkCost& cost, std::uint32_t& tests) {
  Deadline never;
  const NearestSurface nearest =
      nearest_surface(solid, outer, point, never, cost, tests).value_or(NearestSurface{.point = point});
  const ObjectInfo& info = *inner.info;
  const bool is_lone = info.primitives.size() == 1 && !info.mesh;
  const double inscribed_m = is_lone ? inner_ball(info.primitives.front()).radius_m : 0;
  Contact contact = contact_inside(nearest, way_out(solid, outer, nearest, inscribed_m, inner.bounds));
  contact.normal = -contact.normal;
  return {contact, nearest.triangle};
}

}  // namespace collided::engine
