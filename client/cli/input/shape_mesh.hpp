#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/io.hpp"

namespace collided::cli {

/// How to read a file of triangles, as for `load` and `check`.
struct MeshReading {
  std::string unit = {};  // mm, in, ... or metres a unit; empty: as the format defines
  std::string up = {};    // y or z; empty: as the format defines
};

/// The shape from the words `mesh FILE` or `hull FILE`: the triangles of a file of any format that `check` reads, or
/// the convex hull of their corners. Throws Failure.
ShapePart read_mesh_shape(const std::vector<std::string>& words, const MeshReading& reading, const Io& io);

/// The same from the output of the program that reads the file: lines "v X Y Z" and "t A B C".
MeshShape parse_triangles(std::string_view text);

/// Whether this kind of shape is a mesh or a hull.
bool is_mesh_kind(const std::string& kind);

}  // namespace collided::cli
