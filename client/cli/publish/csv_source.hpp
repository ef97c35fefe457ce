#pragma once

#include <memory>
#include <string>

#include "client/cli/io.hpp"
#include "client/cli/publish/source.hpp"

namespace collided::cli {

struct CsvSourceOptions {
  std::string path;  // "-": stdin
  ShapePart shape = SphereShape{.radius_m = 0.1};
  ObjectTexts objects = {};
  bool paced = false;  // a rate was given, so that times may be missing
};

/// Poses from a CSV file or pipe; rows of one time are one frame. Objects are added when first seen.
std::unique_ptr<Source> make_csv_source(Io& io, const CsvSourceOptions& options);

}  // namespace collided::cli
