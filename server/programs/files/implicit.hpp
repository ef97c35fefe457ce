#pragma once

#include <string>
#include <vector>

namespace collided::engine::files {

/// A question about an implicit surface, as the user wrote it.
struct ImplicitOptions {
  std::string surface;  // a polynomial, or a name in the file
  std::string file{};   // a .surfaces file; empty: `surface` is a polynomial
  std::vector<std::string>
      numbers;           // a point X Y Z, a ray X Y Z DX DY DZ, or "-": many of either from stdin, one a line
  std::string length{};  // of rays, in m; empty or "inf": no end
  std::string within{};  // accepted error of distances, a length with a unit; empty: as small as double allows
  bool as_json = false;  // one JSON object an answer
};

/// Prints where rays meet an implicit surface, or on which side of it points are. Exit codes are those of `collide`: 0
/// hit, inside or on; 1 miss or outside; 3 undecided; 6 some lines of a batch were refused. Throws LoadError for
/// questions that cannot be answered.
int implicit(const ImplicitOptions& options);

}  // namespace collided::engine::files
