#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Vertex numbers of fans or strips, one list for each.
using Runs = std::vector<std::vector<std::uint32_t>>;

/// The mesh as triangle fans; each triangle is in one of them, with its orientation. Greedy: vertices with most
/// triangles first.
/// cost  O(n log n)
Runs fans_of(const TriangleMesh& mesh);

/// The mesh as triangle strips. A strip ends where no unused triangle continues it.
/// cost    O(n log n)
/// source  greedy: Akeley, Haeberli, Burns, "tomesh", 1990
Runs strips_of(const TriangleMesh& mesh);

/// The memory of a mesh in one encoding, including its vertices of three doubles.
struct EncodingSize {
  std::string name;
  std::size_t bytes = 0;
  double bytes_a_triangle = 0;
};

/// The sizes as lists, fans and strips that contain their vertices, with 4 bytes for the length of each run, and as the
/// indexed mesh.
std::vector<EncodingSize> encoding_sizes(const TriangleMesh& mesh);

}  // namespace collided::engine
