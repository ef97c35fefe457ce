#include "server/programs/files/simplifying.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"
#include "server/programs/files/file_options.hpp"
#include "server/programs/files/interrupt.hpp"
#include "server/programs/files/progress_line.hpp"
#include "server/world/objects/scene_levels.hpp"
#include "server/world/objects/surface_distance.hpp"

namespace collided::engine::files {
namespace {

/// The number of triangles for the user's target; throws LoadError.
std::size_t triangles_asked(const std::string& target, std::size_t triangle_count) {
  double number = 0;
  const char* const end = target.data() + target.size();
  const auto [stop, error] = std::from_chars(target.data(), end, number);
  const bool is_share = stop != end && *stop == '%';
  const bool is_whole = stop + (is_share ? 1 : 0) == end && error == std::errc{};
  if (!is_whole || !(number > 0 && number <= (is_share ? 100 : 1e15))) {
    throw LoadError(
        fmt::format("--to '{}'; a number of triangles, or of per cent of them, is needed: 5000 or 10%", target));
  }
  return static_cast<std::size_t>(is_share ? std::ceil(number / 100 * static_cast<double>(triangle_count)) : number);
}

CollapseOrder simplified(const Scene& scene, std::size_t triangles_at_most, CollapseCost cost, SimplifyReport& report) {
  ProgressLine line("simplifying");
  const std::vector<std::uint32_t> part_ends = ends_of_parts(scene.parts);
  CollapseOrder order = simplify(scene.mesh,
                                 {.cost = cost,
                                  .triangles_at_most = triangles_at_most,
                                  .part_ends = part_ends,
                                  .progress = [&](double fraction) { line.tell(fraction); },
                                  .cancelled = is_interrupted},
                                 report);
  end_if_interrupted();
  return order;
}

/// A bound in three digits, rounded upward so that it stays one.
std::string rounded_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return shortest(value);
  const double step = std::pow(10, std::floor(std::log10(value)) - 2);
  double shown = std::stod(fmt::format("{:.2e}", value));
  if (shown < value) shown = std::stod(fmt::format("{:.2e}", shown + step));
  return shortest(shown);
}

/// The size to which a change by simplification is compared.
double diagonal_m(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds.empty() ? 0 : (bounds.high - bounds.low).norm();
}

std::string refusals(const SimplifyReport& report) {
  return fmt::format(
      "refused: {} collapses that would turn a normal by 90 degrees, {} that would cross the surface, {} that would "
      "change how it hangs together",
      grouped(report.flip_refusals), grouped(report.crossing_refusals), grouped(report.topology_refusals));
}

/// Gives each part its remaining run of triangles in the level; parts without any are removed.
void recount_parts(const LevelTriangles& level, std::vector<Part>& parts) {
  auto next = level.originals.begin();
  std::uint32_t first = 0;
  for (Part& part : parts) {
    const auto end = std::lower_bound(next, level.originals.end(), part.first_triangle + part.triangle_count);
    part.first_triangle = first;
    part.triangle_count = static_cast<std::uint32_t>(end - next);
    first += part.triangle_count;
    next = end;
  }
  std::erase_if(parts, [](const Part& part) { return part.triangle_count == 0; });
}

}  // namespace

void simplify_to(Scene& scene, const std::string& target, CollapseCost cost) {
  const std::size_t count = scene.mesh.triangles.size();
  const std::size_t asked = triangles_asked(target, count);
  if (asked >= count) {
    fmt::print("  simplify  nothing: {} triangles are asked for, the file has {}\n", grouped(asked), grouped(count));
    return;
  }
  SimplifyReport report;
  const CollapseOrder order = simplified(scene, asked, cost, report);
  const LevelTriangles level = level_with(scene.mesh, order, asked);
  const std::vector<std::uint32_t> part_of = parts_of_triangles(scene.parts, count);
  std::vector<std::uint32_t> level_part_of;
  for (const std::uint32_t original : level.originals) level_part_of.push_back(part_of[original]);
  TriangleMesh simpler = compact_mesh(scene.mesh, level);
  const Bvh tree = Bvh::build(scene.mesh);
  const Bvh simpler_tree = Bvh::build(simpler);
  constexpr double kNoticeable = 0.05;  // of the diagonal
  // Measured on the finished meshes, from both sides.
  const double off_by_m = surface_distance({scene.mesh, tree, part_of}, {simpler, simpler_tree, level_part_of});
  fmt::print("  simplify  {} of {} triangles, no point of either surface farther than {} m from the other\n",
             grouped(simpler.triangles.size()), grouped(count), rounded_up(off_by_m));
  if (const double size_m = diagonal_m(scene.mesh); off_by_m > kNoticeable * size_m) {
    fmt::print(
        "  warning   that is {:.0f} per cent of its size: parts of it are gone or bent; --to a larger number "
        "keeps more\n",
        100 * off_by_m / size_m);
  }
  if (simpler.triangles.size() > asked)
    fmt::print("            {} were asked for; the guards let no more go\n", grouped(asked));
  fmt::print("            {}\n", refusals(report));
  recount_parts(level, scene.parts);
  scene.mesh = std::move(simpler);
}

void add_levels(Scene& scene, CollapseCost cost) {
  if (scene.mesh.triangles.empty()) return;
  SimplifyReport report;
  scene.collapses = simplified(scene, 0, cost, report);
  const Bvh tree = Bvh::build(scene.mesh);
  const auto levels = build_levels(scene.mesh, tree, scene.parts, scene.collapses, {});
  if (levels.empty()) fmt::print("  level    none: the mesh does not get much simpler without being far off\n");
  for (const auto& level : levels) {
    fmt::print("  level    {} triangles, distances within {} m\n", grouped(level->mesh.triangles.size()),
               rounded_up(level->off_by_m));
  }
  fmt::print("           {}\n", refusals(report));
}

}  // namespace collided::engine::files
