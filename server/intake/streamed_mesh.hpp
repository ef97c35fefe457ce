#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/intake/tiles/mesh_source.hpp"

namespace collided::engine {

/// A scene of triangles whose mesh stays in its file.
struct StreamedMesh {
  std::string name;
  std::vector<Part> parts;
  std::unique_ptr<MeshSource> mesh;  // placed as the options say
};

/// Opens a file to be read piece by piece, in far less memory than its mesh takes: a binary PLY file of triangles. The
/// mesh is what load_scene gives, but equal vertices and triangles are not looked for. options.max_file_bytes and
/// max_triangles do not count.
///
/// returns   nothing where the file or the options need all of it in memory
/// throws    LoadError
std::optional<StreamedMesh> stream_mesh(const std::string& path, const LoadOptions& options, LoadReport& report);

}  // namespace collided::engine
