#pragma once

#include <memory>
#include <string>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

/// What to read, and the shape of each object.
struct CsvSourceOptions {
  std::string path;  // "-": stdin
  ShapePart shape = SphereShape{.radius_m = 0.1};
  ObjectTexts objects = {};
  bool paced = false;  // a rate was given, so the rows need no times
};

/// A source of poses from a CSV file or pipe. Rows with the same time are one frame. An object is added when its name
/// first occurs.
std::unique_ptr<MotionSource> make_csv_source(Io& io, const CsvSourceOptions& options);

}  // namespace collided::cli
