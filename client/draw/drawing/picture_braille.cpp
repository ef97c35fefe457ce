#include <algorithm>
#include <cmath>

#include "client/draw/drawing/picture.hpp"

namespace collided::draw {
namespace {

/// The bit of a dot in its character, by column and row. Source: Unicode, "Braille Patterns", U+2800.
constexpr unsigned kDots[2][4] = {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}};

std::string sign(unsigned dots) {
  const unsigned code = 0x2800 + dots;
  return {static_cast<char>(0xe0 | (code >> 12)), static_cast<char>(0x80 | ((code >> 6) & 0x3f)),
          static_cast<char>(0x80 | (code & 0x3f))};
}

}  // namespace

std::string as_braille(const Picture& picture) {
  const int columns = static_cast<int>(std::ceil(picture.width_px / 2));
  const int rows = static_cast<int>(std::ceil(picture.height_px / 4));
  std::vector<unsigned> cells(static_cast<std::size_t>(columns) * rows, 0);
  const auto dot = [&](const Spot& p) {
    const int x = static_cast<int>(std::floor(p[0]));
    const int y = static_cast<int>(std::floor(p[1]));
    if (x < 0 || y < 0 || x >= 2 * columns || y >= 4 * rows) return;
    cells[static_cast<std::size_t>(y / 4) * columns + x / 2] |= kDots[x % 2][y % 4];
  };
  for (const Stroke& stroke : picture.strokes) {
    for (std::size_t i = 1; i < stroke.points.size(); ++i) {
      const Spot& a = stroke.points[i - 1];
      const Spot& b = stroke.points[i];
      const int steps = 1 + static_cast<int>(std::ceil(2 * std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1]))));
      for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        dot({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
      }
    }
  }
  std::string text;
  for (int y = 0; y < rows; ++y) {
    std::string line;
    for (int x = 0; x < columns; ++x) line += sign(cells[static_cast<std::size_t>(y) * columns + x]);
    // Blank characters at the end of a line, of three bytes each, are removed.
    while (line.ends_with(sign(0))) line.resize(line.size() - 3);
    text += line + '\n';
  }
  return text;
}

}  // namespace collided::draw
