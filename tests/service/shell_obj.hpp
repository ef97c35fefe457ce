#pragma once

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

namespace collided::testing_support {

/// The text of an OBJ file with a sphere about (50, 50, 50), of 4 * rows^2 triangles. To its centre all of them are
/// about as near, so that a nearest point there costs the most.
inline std::string shell_obj(int rows, double radius_m = 1) {
  std::ostringstream text;
  text.precision(17);
  const int columns = 2 * rows;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double polar = std::numbers::pi * row / rows;
      const double turn = 2 * std::numbers::pi * column / columns;
      text << "v " << 50 + radius_m * std::sin(polar) * std::cos(turn) << ' '
           << 50 + radius_m * std::sin(polar) * std::sin(turn) << ' ' << 50 + radius_m * std::cos(polar) << '\n';
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int a = row * columns + column + 1;
      const int b = row * columns + (column + 1) % columns + 1;
      text << "f " << a << ' ' << b << ' ' << a + columns << "\nf " << b << ' ' << b + columns << ' ' << a + columns
           << '\n';
    }
  }
  return text.str();
}

}  // namespace collided::testing_support
