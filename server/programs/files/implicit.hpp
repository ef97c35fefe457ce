#pragma once

#include <string>
#include <vector>

namespace collided::engine::files {

struct ImplicitOptions {
  std::string surface;  // a polynomial, or a name in the file
  std::string file{};   // .surfaces
  std::vector<std::string>
      numbers;           // a point X Y Z, a ray X Y Z DX DY DZ, or "-": many of either from stdin, one a line
  std::string length{};  // of rays; empty: no end
  std::string within{};  // error asked of distances; empty: as sharp as double tells
  bool as_json = false;
};

/// Where rays meet an implicit surface, on which side points are. Exit codes are those of `collide`: 0 hit, inside or on,
/// 1 miss or outside, 3 undecided, 6 some lines of a batch were refused. Throws LoadError for what cannot be asked.
int implicit(const ImplicitOptions& options);

}  // namespace collided::engine::files
