#include "server/programs/files/tiling.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "server/intake/streamed_mesh.hpp"
#include "server/programs/files/file_options.hpp"
#include "server/programs/files/interrupt.hpp"
#include "server/programs/files/progress_line.hpp"

namespace collided::engine::files {
namespace {

/// A mesh with its entry in a tile file.
struct NamedMesh {
  const std::string& name;
  const std::string& source;
  const std::vector<Part>& parts;
  MeshSource& mesh;
};

void write(const std::string& path, const NamedMesh& from, const std::string& tiles) {
  ProgressLine line("writing tiles");
  TilingOptions options = tiling_of(tiles);
  options.progress = [&](double fraction) { line.tell(fraction); };
  options.cancelled = is_interrupted;
  const std::string source = std::filesystem::path(from.source).filename().string();
  const TilingReport report = write_tiles(path, from.name, source, from.parts, from.mesh, options);
  fmt::print("  tiles    {} of at most {}, {} bytes\n", grouped(report.tiles),
             counted(report.largest_triangles, "triangle"), grouped(report.bytes));
}

/// Calling off is not an error.
template <class Work>
auto interruptible(const Work& work) {
  try {
    return work();
  } catch (const LoadError&) {
    end_if_interrupted();
    throw;
  }
}

}  // namespace

TilingOptions tiling_of(const std::string& text) {
  TilingOptions options;
  if (text != "auto") options.size_m = length_in_metres("--tiles", text);
  return options;
}

void write_in_tiles(const std::string& path, const std::string& source, const Scene& scene, const std::string& tiles) {
  if (!scene.objects.empty())
    throw LoadError(fmt::format("{}: only meshes are cut into tiles, and it has {}. Nothing was written.", source,
                                counted(scene.objects.size(), "object")));
  if (scene.frozen)
    throw LoadError(fmt::format("{}: a snapshot says more than tiles hold. Nothing was written.", source));
  HeldMeshSource mesh(scene.mesh);
  interruptible([&] { write(path, {scene.name, source, scene.parts, mesh}, tiles); });
}

bool stream_into_tiles(const std::string& path, const FileOptions& file, const std::string& tiles, LoadReport& report) {
  LoadOptions options = load_options(file);
  return interruptible([&] {
    LoadReport of_stream;
    std::optional<StreamedMesh> streamed;
    {
      ProgressLine line("reading");
      options.progress = [&](double fraction) { line.tell(fraction); };
      streamed = stream_mesh(file.path, options, of_stream);
    }
    if (!streamed) return false;
    report = std::move(of_stream);
    fmt::print("{}  {}, {}, 0 objects\n", streamed->name, counted(streamed->parts.size(), "part"),
               counted(streamed->mesh->triangle_count(), "triangle"));
    write(path, {streamed->name, file.path, streamed->parts, *streamed->mesh}, tiles);
    return true;
  });
}

}  // namespace collided::engine::files
