#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/intake/scene.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine::service {

/// A scene ready to become part of a world.
struct LoadedScene {
  Scene scene;  // its triangles are in `indexed`
  std::shared_ptr<StaticScene> indexed;
  LoadReport report;
  std::uint64_t triangles = 0;
  double seconds = 0;  // reading and indexing
};

/// Reads and indexes a file; slow. progress: fraction of both done. Throws LoadError.
LoadedScene load_and_index(const std::string& path, LoadOptions options);
/// The scene that a server without an argument serves.
LoadedScene embedded_and_indexed();

/// "warehouse: 1204118 triangles in 312 parts, 40 objects, 412 ms", then a line for each thing mended, refused or
/// noteworthy.
std::string describe(const LoadedScene& loaded);

}  // namespace collided::engine::service
