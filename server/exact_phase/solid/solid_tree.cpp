#include "server/exact_phase/solid/solid_tree.hpp"

#include <array>

#include "server/exact_phase/solid/point_signs.hpp"

namespace collided::engine {

int SolidTree::side_of(const SplitNode& node, const Vec3& point) const {
  const SplitPlane& plane = node.plane;
  if (plane.is_across()) {
    const double at = point[plane.axis()];
    return at > plane.offset ? 1 : at < plane.offset ? -1 : 0;
  }
  const double height = plane.normal.dot(point) - plane.offset;
  if (height > plane.error) return 1;
  if (height < -plane.error) return -1;
  return PlainPoint(point).height(mesh_->triangle(plane.triangle));
}

std::optional<SolidSide> SolidTree::side(const Vec3& point, std::uint32_t& nodes) const {
  if ((point.array() < bounds_.low.array()).any() || (point.array() > bounds_.high.array()).any())
    return SolidSide::out;
  // A point on a plane is in both halves; if the leaves around it differ, it is on the surface.
  constexpr std::size_t kMostPaths = 64;
  std::array<std::uint32_t, kMostPaths> waiting;
  std::size_t count = 0;
  bool some_out = false;
  bool some_in = false;
  std::uint32_t at = 0;
  while (true) {
    while (at < kIn) {
      const SplitNode& node = nodes_[at];
      ++nodes;
      const int side = side_of(node, point);
      if (side == 0) {
        if (count == kMostPaths) return std::nullopt;
        waiting[count++] = node.back;
      }
      at = side >= 0 ? node.front : node.back;
    }
    (at == kOut ? some_out : some_in) = true;
    if (some_out && some_in) return SolidSide::on;
    if (count == 0) return some_in ? SolidSide::in : SolidSide::out;
    at = waiting[--count];
  }
}

}  // namespace collided::engine
