#include "server/service/commands/scene_loading.hpp"

#include <fmt/format.h>

#include "idl/clocks.hpp"
#include "idl/glob.hpp"
#include "server/intake/held_parts.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {
namespace {

// Of the progress: reading a text mesh takes about as long as indexing it.
constexpr double kReadingShare = 0.5;

std::string counted(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

void declare(LoadedScene& loaded, const LoadOptions& options) {
  DeclaredSolids declared =
      declare_solids(loaded.indexed.scene, *loaded.indexed.geometry, options.solid, options.cancelled,
                     options.solid_by_winding ? SolidBy::winding : SolidBy::closing);
  LoadReport& report = loaded.report;
  if (declared.count > 0)
    report.notes.push_back(fmt::format(
        "{} declared solid", declared.count == 1 ? "1 mesh is" : fmt::format("{} meshes are", declared.count)));
  if (declared.by_winding > 0)
    report.notes.push_back(fmt::format("{} solid by winding number",
                                       declared.by_winding == 1
                                           ? "1 mesh that does not close is"
                                           : fmt::format("{} meshes that do not close are", declared.by_winding)));
  if (!options.solid.empty() && declared.count + declared.by_winding == 0 && declared.refused.empty())
    report.warnings.push_back("nothing with a mesh is named '" + options.solid + "', so nothing is solid");
  report.refused.insert(report.refused.end(), declared.refused.begin(), declared.refused.end());
  report.warnings.insert(report.warnings.end(), declared.warnings.begin(), declared.warnings.end());
}

/// The part of the scene that a shard holds, as a sentence.
std::string held_by(const ShardPlace& shard, const Scene& scene, const LeftOutOfScene& left_out) {
  if (!scene.tiles)
    return fmt::format("shard '{}' leaves out {} and {}: they lie outside of its box and margin", shard.name,
                       counted(left_out.parts, "part"), counted(left_out.objects, "object"));
  return fmt::format("shard '{}' holds {} of {}, in {} of {}: the others lie outside of its box and margin", shard.name,
                     scene.mesh.triangles.size(), counted(scene.tiles->triangles_of_file, "triangle"),
                     scene.parts.size(), counted(scene.tiles->parts_of_file, "part"));
}

LoadedScene index(Scene scene, LoadReport report, const LoadOptions& options, std::int64_t started_ns) {
  LoadedScene loaded{.indexed = {}, .report = std::move(report)};
  loaded.triangles = scene.mesh.triangles.size();
  Aabb bounds;
  for (const Vec3& vertex : scene.mesh.vertices) bounds.extend(vertex);  // before the index takes them
  const std::string unit_doubt = unit_suspicion(bounds);
  BvhOptions bvh;
  if (options.progress) {
    bvh.progress = [&](double fraction) { options.progress(kReadingShare + (1 - kReadingShare) * fraction); };
  }
  bvh.cancelled = options.cancelled;
  bvh.form = BvhForm::best;
  loaded.indexed = World::index_scene(std::move(scene), bvh);
  if (options.cancelled && options.cancelled())
    throw LoadError(loaded.indexed.scene.name + ": the load was called off. Nothing was loaded.");
  const std::vector<std::string>& of_indexes = loaded.indexed.geometry->warnings;
  std::vector<std::string>& warnings = loaded.report.warnings;
  warnings.insert(warnings.end(), of_indexes.begin(), of_indexes.end());
  if (!unit_doubt.empty()) warnings.push_back(unit_doubt);
  if (!options.solid.empty() || loaded.indexed.scene.frozen) declare(loaded, options);
  loaded.seconds = static_cast<double>(steady_ns() - started_ns) * wire_contract::kNanosecond_s;
  return loaded;
}

}  // namespace

LoadedScene load_and_index(const std::string& path, LoadOptions options, const ShardPlace* shard, bool is_moving) {
  const std::int64_t started_ns = steady_ns();
  LoadReport report;
  LoadOptions reading = options;
  if (options.progress) {
    reading.progress = [&](double fraction) { options.progress(kReadingShare * fraction); };
  }
  if (shard != nullptr) {
    reading.within = shard->held;
    // What a part encloses can be computed only from all of it.
    reading.needed_whole = [&](std::string_view part) { return wire_contract::glob_matches(options.solid, part); };
  }
  Scene scene = path == kEmbeddedPath ? embedded_scene() : load_scene(path, reading, report);
  if (scene.tiles)
    report.notes.push_back(
        fmt::format("{} of {} read", scene.tiles->tiles, counted(scene.tiles->tiles_of_file, "tile")));
  if (shard != nullptr) report.notes.push_back(held_by(*shard, scene, leave_out_beyond(shard->held, scene, is_moving)));
  return index(std::move(scene), std::move(report), options, started_ns);
}

std::string describe(const LoadedScene& loaded) {
  const Scene& scene = loaded.indexed.scene;
  std::string text =
      fmt::format("{}: {} in {}, {}, {:.0f} ms", scene.name, counted(loaded.triangles, "triangle"),
                  counted(scene.parts.size(), "part"), counted(scene.objects.size(), "object"), loaded.seconds * 1e3);
  for (const std::string& line : loaded.report.placed) text += "\n  placed   " + line;
  for (const std::string& line : loaded.report.notes) text += "\n  note     " + line;
  for (const std::string& line : loaded.report.mended) text += "\n  mended   " + line;
  for (const std::string& line : loaded.report.refused) text += "\n  refused  " + line;
  for (const std::string& line : loaded.report.warnings) text += "\n  warning  " + line;
  return text;
}

}  // namespace collided::engine::service
