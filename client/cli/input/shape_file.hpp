#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/io.hpp"

namespace collided::cli {

/// Makes a shape from a kind and its further words: those of make_shape, or points FILE R | polyline FILE R | heights
/// FILE DX [DY], whose file has rows of numbers separated by blanks or commas, and comments after '#', "-" being
/// standard input; or mesh FILE | hull FILE. A colon may replace the first blank: hull:part.stl. Throws Failure, with
/// the line of a file.
///
/// reading  for mesh and hull; other shapes refuse it
ShapePart shape_of_words(std::vector<std::string> words, const Io& io, const MeshReading& reading = {});

/// The same from one text: sphere:0.1, box:0.4,0.4,0.4, mesh:part.stl, points:cloud.xyz,1cm.
ShapePart shape_of_text(const std::string& text, const Io& io);

}  // namespace collided::cli
