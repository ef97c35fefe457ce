#include "server/service/commands/fence_prism.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "server/intake/polygons/planar.hpp"
#include "server/intake/polygons/triangulate.hpp"

namespace collided::engine::service {
namespace {

/// The ring's direction at its lowest corner, the leftmost of those: +1 to the left, 0 if it is flat there.
int turn_of_ring(std::span<const std::array<double, 2>> corners) {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const bool is_lower = corners[i][1] < corners[lowest][1] ||
                          (corners[i][1] == corners[lowest][1] && corners[i][0] < corners[lowest][0]);
    if (is_lower) lowest = i;
  }
  const std::size_t count = corners.size();
  return turn(corners[(lowest + count - 1) % count], corners[lowest], corners[(lowest + 1) % count]);
}

}  // namespace

std::variant<std::shared_ptr<const TriangleMesh>, Refusal> upright_prism(std::span<const std::array<double, 2>> corners,
                                                                         double low_m, double high_m) {
  if (corners.size() < 3) return Refusal{"a prism's polygon has three corners or more"};
  if (!(low_m < high_m)) return Refusal{"a prism's low end lies below its high one"};
  const int way = turn_of_ring(corners);
  if (way == 0) return Refusal{"the prism's polygon folds back on itself at its lowest corner"};
  auto mesh = std::make_shared<TriangleMesh>();
  const auto count = static_cast<std::uint32_t>(corners.size());
  // The ring at the bottom, then that at the top, both to the left.
  for (const double height_m : {low_m, high_m}) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::array<double, 2>& corner = corners[way > 0 ? i : count - 1 - i];
      mesh->vertices.emplace_back(corner[0], corner[1], height_m);
    }
  }
  std::vector<std::uint32_t> ring(count);
  std::iota(ring.begin(), ring.end(), 0u);
  std::vector<TriangleCorners> cap;
  const PolygonKind kind = triangulate(ring, mesh->vertices, cap);
  if (kind == PolygonKind::crossing || kind == PolygonKind::too_long)
    return Refusal{"the prism's polygon crosses or touches itself"};
  for (const TriangleCorners& t : cap) {
    mesh->triangles.push_back({t[0], t[2], t[1]});
    mesh->triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh->triangles.push_back({i, next, next + count});
    mesh->triangles.push_back({i, next + count, i + count});
  }
  return mesh;
}

}  // namespace collided::engine::service
