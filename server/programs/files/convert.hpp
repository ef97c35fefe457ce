#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

/// The options of `collide convert`.
struct ConvertOptions {
  FileOptions file;
  std::string output;            // path, ending in .cscene, or with `tiles` in .ctiles
  bool center = false;           // the middle, rounded to whole metres, becomes 0 0 0; excludes `origin`
  std::string origin;            // "X,Y,Z": this point becomes 0 0 0
  std::string index = "fast";    // how the saved indexes are built: "fast" or "best"
  std::string to{};              // simplify to this many triangles, or to a percentage ("10%"); empty: not at all
  std::string cost = "quadric";  // what simplification minimises: "quadric" or "length"
  bool levels = false;           // save the order of simplification, for levels of detail
  bool no_index = false;         // save no index; loading the file builds it
  std::string tiles{};  // cut the mesh into cubes of this length, or into tiles of about as many triangles: "auto"
};

/// Reads a file and writes it as a scene file with the index of each mesh, moved and simplified as the options say, or
/// as a tile file. Returns 0 if the whole file was accepted, 1 if something was refused. Throws LoadError or
/// Interrupted.
int convert(const ConvertOptions& options);

}  // namespace collided::engine::files
