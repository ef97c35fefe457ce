#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/draw/drawing/tones.hpp"

namespace collided::draw {
namespace {

/// The least darkness in [0, 1] at which a line is drawn. Lines far apart come first, those between them at darker
/// tones; the pattern repeats after 8 lines.
double threshold_of(int line) {
  static constexpr int kTurn[8] = {0, 4, 2, 6, 1, 5, 3, 7};  // bits reversed
  return (kTurn[static_cast<std::size_t>(((line % 8) + 8) % 8)] + 0.5) / 8;
}

/// Lines at one angle. The first of them are drawn from darkness `from` on, all of them at `to`.
struct Family {
  double angle_rad;
  double from;
  double to;
};
constexpr Family kFamilies[] = {{-std::numbers::pi / 4, 0.15, 0.65}, {std::numbers::pi / 4, 0.6, 1}};

}  // namespace

std::vector<std::vector<Spot>> hatching(const ToneMap& map, double spacing_px) {
  std::vector<std::vector<Spot>> strokes;
  const auto is_drawn = [&](double x, double y, const Family& family, double threshold) {
    if (!(x >= 0 && y >= 0 && x < map.width && y < map.height)) return false;
    const float light = map.light[static_cast<std::size_t>(y) * map.width + static_cast<std::size_t>(x)];
    if (light == ToneMap::kNothing) return false;
    return (1 - static_cast<double>(light) - family.from) / (family.to - family.from) > threshold;
  };
  for (const Family& family : kFamilies) {
    const double along_x = std::cos(family.angle_rad);
    const double along_y = std::sin(family.angle_rad);
    // Across the lines, from the corner that comes first to the one that comes last.
    const auto across = [&](double x, double y) { return -along_y * x + along_x * y; };
    const auto along = [&](double x, double y) { return along_x * x + along_y * y; };
    const auto [low, high] =
        std::minmax({across(0, 0), across(map.width, 0), across(0, map.height), across(map.width, map.height)});
    const auto [first, last] =
        std::minmax({along(0, 0), along(map.width, 0), along(0, map.height), along(map.width, map.height)});
    for (int line = static_cast<int>(std::floor(low / spacing_px)); line * spacing_px <= high; ++line) {
      const double offset = line * spacing_px;
      const auto spot = [&](double s) { return Spot{s * along_x - offset * along_y, s * along_y + offset * along_x}; };
      double begun = NAN;
      for (double s = first; s <= last + 1; s += 1) {
        const Spot p = spot(s);
        const bool drawn = s <= last && is_drawn(p[0], p[1], family, threshold_of(line));
        if (drawn && std::isnan(begun)) begun = s;
        if (!drawn && !std::isnan(begun)) {
          if (s - begun > 1) strokes.push_back({spot(begun), spot(s - 1)});
          begun = NAN;
        }
      }
    }
  }
  return strokes;
}

}  // namespace collided::draw
