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
  std::unique_ptr<MeshSource> mesh;  // placed by the options
};

/// Opens a binary PLY file of triangles to be read piece by piece, in far less memory than its mesh takes. The mesh is
/// that of load_scene, without a search for equal vertices and triangles. options.max_file_bytes and max_triangles are
/// ignored.
///
/// returns   nothing if the file or the options need all of it in memory
/// throws    LoadError
std::optional<StreamedMesh> stream_mesh(const std::string& path, const LoadOptions& options, LoadReport& report);

}  // namespace collided::engine
