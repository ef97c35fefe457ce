#pragma once

#include <memory>
#include <optional>
#include <string>

#include <collided/voxels.hpp>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// A scan published as occupied cells.
struct VoxelSourceOptions {
  std::string path;  // of any format whose points `load` reads
  std::string name;  // of the cells' objects
  VoxelOptions voxels = {};
  std::optional<Vec3> origin = {};  // of the sensor
  ObjectTexts objects = {};
  double rate_hz = 1;  // of frames, each of which integrates the scan once more
};

/// Reads the scan, and integrates it in every frame. Throws Failure for a file without points.
std::unique_ptr<MotionSource> make_voxel_source(const Io& io, const VoxelSourceOptions& options);

}  // namespace collided::cli
