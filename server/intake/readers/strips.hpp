#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// Vertex numbers of fans or strips, one list each.
using Runs = std::vector<std::vector<std::uint32_t>>;

/// The mesh as triangle fans: each triangle in one of them, with its orientation. Greedy, the fullest corners first.
/// cost  O(n log n)
Runs fans_of(const TriangleMesh& mesh);

/// The mesh as triangle strips. A strip ends where no triangle goes on.
/// cost    O(n log n)
/// source  greedy: Akeley, Haeberli, Burns, "tomesh", 1990
Runs strips_of(const TriangleMesh& mesh);

/// What a mesh takes in memory, vertices of three doubles included.
struct EncodingSize {
  std::string name;
  std::size_t bytes = 0;
  double bytes_a_triangle = 0;
};

/// Lists, fans and strips that carry their vertices (and 4 bytes for the length of each run), and the indexed mesh.
std::vector<EncodingSize> encoding_sizes(const TriangleMesh& mesh);

}  // namespace collided::engine
