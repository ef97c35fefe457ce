#include "server/intake/simplify/collapse_order.hpp"

#include <algorithm>

namespace collided::engine {
namespace {

constexpr std::uint32_t kStays = 0xffffffff;

/// By vertex: the number of the step that removes it, or kStays.
std::vector<std::uint32_t> removal_steps(const CollapseOrder& order, std::size_t vertex_count) {
  std::vector<std::uint32_t> step_of(vertex_count, kStays);
  for (std::uint32_t step = 0; step < order.size(); ++step) step_of[order[step].removed] = step;
  return step_of;
}

/// The step in which the triangle vanishes, since two of its corners become equal; kStays if it never does.
std::uint32_t last_step(TriangleCorners corners, const CollapseOrder& order,
                        const std::vector<std::uint32_t>& step_of) {
  while (true) {
    std::size_t first = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (step_of[corners[k]] < step_of[corners[first]]) first = k;
    }
    const std::uint32_t step = step_of[corners[first]];
    if (step == kStays) return kStays;
    const std::uint32_t kept = order[step].kept;
    if (kept == corners[(first + 1) % 3] || kept == corners[(first + 2) % 3]) return step;
    corners[first] = kept;
  }
}

}  // namespace

std::string flaw_of(const CollapseOrder& order, std::size_t vertex_count) {
  std::vector<bool> gone(vertex_count, false);
  for (std::size_t step = 0; step < order.size(); ++step) {
    const auto [removed, kept] = order[step];
    const std::string where = "collapse " + std::to_string(step) + ": ";
    if (std::max(removed, kept) >= vertex_count) {
      return where + "vertex " + std::to_string(std::max(removed, kept)) + " of " + std::to_string(vertex_count);
    }
    if (removed == kept || gone[removed] || gone[kept]) {
      return where + "vertex " + std::to_string(gone[kept] ? kept : removed) + " is gone already or its own heir";
    }
    gone[removed] = true;
  }
  return {};
}

LevelTriangles level_after(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t collapse_count) {
  std::vector<std::uint32_t> heir(mesh.vertices.size());
  for (std::uint32_t i = 0; i < heir.size(); ++i) heir[i] = i;
  // Backwards, so that the vertex that finally replaces `kept` is known already.
  for (std::size_t step = std::min(collapse_count, order.size()); step-- > 0;) {
    heir[order[step].removed] = heir[order[step].kept];
  }
  LevelTriangles level;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const TriangleCorners& from = mesh.triangles[i];
    const TriangleCorners to{heir[from[0]], heir[from[1]], heir[from[2]]};
    const bool was_whole = from[0] != from[1] && from[1] != from[2] && from[2] != from[0];
    const bool is_whole = to[0] != to[1] && to[1] != to[2] && to[2] != to[0];
    if (was_whole && !is_whole) continue;
    level.triangles.push_back(to);
    level.originals.push_back(i);
  }
  return level;
}

LevelTriangles level_with(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t triangles_at_most) {
  const std::vector<std::uint32_t> step_of = removal_steps(order, mesh.vertices.size());
  std::vector<std::size_t> vanish_at(order.size(), 0);  // by step: how many triangles vanish in it
  for (const TriangleCorners& corners : mesh.triangles) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    if (const std::uint32_t step = last_step(corners, order, step_of); step != kStays) ++vanish_at[step];
  }
  std::size_t left = mesh.triangles.size();
  std::size_t collapse_count = 0;
  while (left > triangles_at_most && collapse_count < order.size()) left -= vanish_at[collapse_count++];
  return level_after(mesh, order, collapse_count);
}

TriangleMesh compact_mesh(const TriangleMesh& mesh, const LevelTriangles& level) {
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  for (const TriangleCorners& corners : level.triangles) {
    for (const std::uint32_t corner : corners) number[corner] = 1;
  }
  TriangleMesh compact;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == 0) continue;
    number[i] = static_cast<std::uint32_t>(compact.vertices.size());
    compact.vertices.push_back(mesh.vertices[i]);
  }
  compact.triangles.reserve(level.triangles.size());
  for (const TriangleCorners& c : level.triangles)
    compact.triangles.push_back({number[c[0]], number[c[1]], number[c[2]]});
  return compact;
}

}  // namespace collided::engine
