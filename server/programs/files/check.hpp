#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

struct CheckOptions {
  bool as_json = false;
  double crease_deg = 30;
  bool volumes = false;    // the table of bounding volumes besides
  bool encodings = false;  // the table of bytes as lists, fans, strips and a mesh besides
  std::string eye{};       // "X,Y,Z"; empty: no silhouettes are counted
};

/// Prints what a file holds, what is wrong with it and what the service does about each. 0: all of it was taken; 1:
/// something was refused.
int check(const FileOptions& file, const CheckOptions& options);

}  // namespace collided::engine::files
