#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/intake/scene.hpp"
#include "server/service/commands/shard_place.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// A scene read and indexed, with the report of the load.
struct LoadedScene {
  IndexedScene indexed;
  LoadReport report;
  std::uint64_t triangles = 0;
  double seconds = 0;  // for reading and indexing
};

/// Reads and indexes a file, which may take minutes. options.progress reports the fraction of both; throws LoadError.
///
/// shard      only what comes into its box is kept of the file; null: all of it
/// is_moving  the file's objects will take poses: all are kept
LoadedScene load_and_index(const std::string& path, LoadOptions options, const ShardPlace* shard = nullptr,
                           bool is_moving = false);

/// Instead of a path: the embedded scene, which a server without an argument serves.
inline constexpr const char* kEmbeddedPath = "embedded:";

/// A report: "warehouse: 1204118 triangles in 312 parts, 40 objects, 412 ms", then a line for each item placed, mended,
/// refused or noteworthy.
std::string describe(const LoadedScene& loaded);

}  // namespace collided::engine::service
