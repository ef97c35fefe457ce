#pragma once

#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

struct ConvertOptions {
  FileOptions file;
  std::string output;  // .cscene
  bool center = false;
  std::string origin;            // "X,Y,Z": this point becomes 0 0 0
  std::string index = "fast";    // how the saved indexes are built: "fast" or "best"
  std::string to{};              // simplified to so many triangles, or to so many per cent ("10%")
  std::string cost = "quadric";  // what simplification goes by: "quadric" or "length"
  bool levels = false;           // the order of simplification is saved, for levels of detail
  bool no_index = false;         // none is saved; whoever loads the file builds it
};

/// Reads a file and writes it as a scene file with the index of each mesh, moved where asked. 0: all of it was taken; 1: something was refused.
int convert(const ConvertOptions& options);

}  // namespace collided::engine::files
