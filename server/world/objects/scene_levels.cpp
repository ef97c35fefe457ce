#include "server/world/objects/scene_levels.hpp"

#include <algorithm>

#include "server/world/objects/surface_distance.hpp"

namespace collided::engine {
namespace {

// Each level has a quarter of the triangles of the one before.
constexpr std::size_t kFewerBy = 4;

/// With fewer triangles a level saves nothing: a query costs as much as its answer.
constexpr std::size_t kFewTriangles = 32;

/// A level that is off by more than the mesh's size divided by this is of no use to any query.
constexpr double kUsefulShare = 16;

}  // namespace

std::uint64_t SceneLevel::bytes() const {
  return tree.report().bytes + mesh.vertices.size() * sizeof(Vec3) +
         mesh.triangles.size() * (sizeof(TriangleCorners) + 8);
}

std::vector<std::uint32_t> parts_of_triangles(const std::vector<Part>& parts, std::size_t triangle_count) {
  std::vector<std::uint32_t> part_of(triangle_count, 0);
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    const auto first = part_of.begin() + parts[part].first_triangle;
    std::fill(first, first + parts[part].triangle_count, part);
  }
  return part_of;
}

std::vector<std::uint32_t> ends_of_parts(const std::vector<Part>& parts) {
  std::vector<std::uint32_t> ends;
  for (const Part& part : parts) ends.push_back(part.first_triangle + part.triangle_count);
  return ends;
}

std::vector<std::shared_ptr<const SceneLevel>> build_levels(const TriangleMesh& mesh, const Bvh& tree,
                                                            const std::vector<Part>& parts, const CollapseOrder& order,
                                                            const std::function<bool()>& cancelled) {
  std::vector<std::shared_ptr<const SceneLevel>> levels;
  const std::vector<std::uint32_t> part_of = parts_of_triangles(parts, mesh.triangles.size());
  const double size_m = (tree.bounds().high - tree.bounds().low).norm();
  std::size_t last_count = mesh.triangles.size();
  while (last_count / kFewerBy >= kFewTriangles && !(cancelled && cancelled())) {
    const LevelTriangles left = level_with(mesh, order, last_count / kFewerBy);
    if (left.triangles.size() > last_count / 2) break;  // edges can no longer be collapsed
    auto level = std::make_shared<SceneLevel>();
    level->mesh = compact_mesh(mesh, left);
    level->originals = left.originals;
    for (const std::uint32_t original : left.originals) level->part_of.push_back(part_of[original]);
    level->tree = Bvh::build(level->mesh, {.progress = {}, .cancelled = {}, .form = BvhForm::fast});
    level->off_by_m =
        surface_distance({mesh, tree, part_of}, {level->mesh, level->tree, level->part_of}, {.cancelled = cancelled});
    if (!(level->off_by_m < size_m / kUsefulShare)) break;
    last_count = left.triangles.size();
    levels.push_back(std::move(level));
  }
  return levels;
}

const SceneLevel* coarsest_within(const std::vector<std::shared_ptr<const SceneLevel>>& levels, double error_m) {
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    if ((*level)->off_by_m <= error_m) return level->get();
  }
  return nullptr;
}

}  // namespace collided::engine
