#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

/// What `collide check` reports besides faults.
struct CheckOptions {
  bool as_json = false;
  double crease_deg = 30;  // angle between two triangles above which their edge is a crease
  bool volumes = false;    // print the table of bounding volumes too
  bool encodings = false;  // print the table of sizes as lists, fans, strips and a mesh too
  bool full = false;       // every finding's places, with full names and digits; else what fits a screen
  bool quiet = false;      // no hint at options for more output
  std::string eye{};       // "X,Y,Z"; empty: no silhouettes are counted
};

/// Prints a file's content, its faults, and how the service handles each finding. Returns 0 if the whole file was
/// accepted, 1 if something was refused. Throws LoadError or Interrupted.
int check(const FileOptions& file, const CheckOptions& options);

}  // namespace collided::engine::files
