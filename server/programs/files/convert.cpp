#include "server/programs/files/convert.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <unordered_set>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/lost_in_sum.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/programs/files/interrupt.hpp"
#include "server/programs/files/progress_line.hpp"
#include "server/programs/files/simplifying.hpp"
#include "server/programs/files/tiling.hpp"

namespace collided::engine::files {
namespace {

Vec3 middle(const Scene& scene) {
  Aabb all;
  for (const Vec3& vertex : scene.mesh.vertices) all.extend(vertex);
  for (const SceneObject& object : scene.objects) all.extend(object.pose.position);
  if (all.empty()) throw LoadError("--center: the file holds nothing that has a middle");
  // In whole metres: most files' numbers stay exact when those are subtracted.
  return (all.low / 2 + all.high / 2).array().round();
}

/// a - b; counts the difference if it was rounded.
double subtract(double a, double b, std::uint64_t& rounded_count) {
  const double difference = a - b;
  if (lost_in_sum(a, -b, difference) != 0) ++rounded_count;
  return difference;
}

void move_to_origin(Scene& scene, const Vec3& origin) {
  std::uint64_t rounded_count = 0;
  for (Vec3& vertex : scene.mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) vertex[axis] = subtract(vertex[axis], origin[axis], rounded_count);
  }
  for (SceneObject& object : scene.objects) {
    for (int axis = 0; axis < 3; ++axis)
      object.pose.position[axis] = subtract(object.pose.position[axis], origin[axis], rounded_count);
  }
  fmt::print("  origin   {},{},{} is now 0 0 0; {} numbers were rounded by that\n", shortest(origin.x()),
             shortest(origin.y()), shortest(origin.z()), grouped(rounded_count));
}

/// Builds the index of a mesh and keeps its bytes; throws Interrupted.
void save_index(const TriangleMesh& mesh, BvhForm form, BvhReport& sum, SavedIndex& index) {
  const Bvh tree = Bvh::build(mesh, {.progress = {}, .cancelled = is_interrupted, .form = form});
  end_if_interrupted();
  const auto bytes = std::make_shared<const std::vector<std::byte>>(tree.saved(mesh));
  index = {*bytes, bytes};
  sum.references += tree.report().references;
  sum.bytes += bytes->size();
  sum.build_s += tree.report().build_s;
}

void add_indexes(Scene& scene, BvhForm form) {
  BvhReport sum;
  std::uint64_t triangles = scene.mesh.triangles.size();
  save_index(scene.mesh, form, sum, scene.index);
  std::unordered_set<const TriangleMesh*> done;  // objects that share a mesh share the index saved with the first one
  for (SceneObject& object : scene.objects) {
    if (!object.shape.mesh || !done.insert(object.shape.mesh.get()).second) continue;
    save_index(*object.shape.mesh, form, sum, object.index);
    triangles += object.shape.mesh->triangles.size();
  }
  if (triangles == 0) return;
  const auto count = static_cast<double>(triangles);
  fmt::print("  index    {:.0f} ms, {:.1f} bytes and {:.2f} references a triangle\n", 1e3 * sum.build_s,
             static_cast<double>(sum.bytes) / count, static_cast<double>(sum.references) / count);
}

Scene load_showing_progress(const FileOptions& file, LoadReport& report) {
  ProgressLine line("reading");
  return load(file, report, [&](double fraction) { line.tell(fraction); });
}

/// Reports contradicting options before anything is read.
void check(const ConvertOptions& options) {
  const bool is_tiled = !options.tiles.empty();
  if (is_tiled && !options.output.ends_with(".ctiles"))
    throw LoadError(fmt::format("{}: --tiles writes a .ctiles file. Nothing was written.", options.output));
  if (!is_tiled && options.output.ends_with(".ctiles"))
    throw LoadError(
        fmt::format("{}: of which size? --tiles 100m, or --tiles auto. Nothing was written.", options.output));
  if (!is_tiled && !options.output.ends_with(".cscene"))
    throw LoadError(fmt::format("{}: only .cscene files are written, and with --tiles .ctiles files", options.output));
  if (is_tiled && (options.levels || options.no_index || options.index != "fast"))
    throw LoadError("--tiles: --levels, --index and --no-index are for .cscene files. Nothing was written.");
  if (is_tiled) tiling_of(options.tiles);
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  std::error_code missing;
  if (!folder.empty() && !std::filesystem::is_directory(folder, missing))
    throw LoadError(fmt::format("{}: there is no folder {}. Nothing was written.", options.output, folder.string()));
  if (options.center && !options.origin.empty()) throw LoadError("--center and --origin exclude each other");
}

void convert_whole(const ConvertOptions& options, LoadReport& report) {
  Scene scene = load_showing_progress(options.file, report);
  fmt::print("{}\n", scene_line(scene));
  if (options.center) move_to_origin(scene, middle(scene));
  if (!options.origin.empty()) move_to_origin(scene, parse_point("--origin", options.origin));
  // The file's indexes and orders belong to the mesh as it was, so they are rebuilt.
  forget_indexes(scene);
  scene.collapses = {};
  const CollapseCost cost = options.cost == "length" ? CollapseCost::edge_length : CollapseCost::quadric;
  if (!options.to.empty()) simplify_to(scene, options.to, cost);
  if (!options.tiles.empty()) return write_in_tiles(options.output, options.file.path, scene, options.tiles);
  if (options.levels) add_levels(scene, cost);
  if (!options.no_index) add_indexes(scene, options.index == "best" ? BvhForm::best : BvhForm::fast);
  save_scene(options.output, scene);
}

}  // namespace

int convert(const ConvertOptions& options) {
  check(options);
  LoadReport report;
  const bool is_changed = options.center || !options.origin.empty() || !options.to.empty();
  const bool is_streamed =
      !options.tiles.empty() && !is_changed && stream_into_tiles(options.output, options.file, options.tiles, report);
  if (!is_streamed) convert_whole(options, report);
  for (const std::string& line : report.placed) fmt::print("  placed   {}\n", line);
  for (const std::string& line : report.notes) fmt::print("  note     {}\n", line);
  for (const std::string& line : report.mended) fmt::print("  mended   {}\n", line);
  for (const std::string& line : report.refused) fmt::print("  refused  {}\n", line);
  for (const std::string& line : report.warnings) fmt::print("  warning  {}\n", line);
  fmt::print("  written  {}\n", options.output);
  return report.refused.empty() ? 0 : 1;
}

}  // namespace collided::engine::files
