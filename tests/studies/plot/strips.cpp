#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/studies/plot/axis_map.hpp"
#include "tests/studies/plot/plot.hpp"

namespace collided::draw {
namespace {

constexpr double kTextSize = 12;
constexpr double kShareSize = 10.5;
constexpr double kRow = 34;
constexpr double kStrip = 20;

const char* color_of(std::size_t part) { return part == 0 ? kAccent : kPalette[(part - 1) % kPaletteSize]; }

}  // namespace

std::string svg(const Strips& strips) {
  double name_width = 60;
  double whole_width = 20;
  for (const Strips::Row& row : strips.rows) {
    name_width = std::max(name_width, text_width(row.name, kTextSize));
    whole_width = std::max(whole_width, text_width(row.whole, kTextSize));
  }
  Canvas canvas(strips.width, 74 + kRow * static_cast<double>(strips.rows.size()), strips.title);
  double y = draw_title(canvas, strips.title);
  double legend_x = 20;
  for (std::size_t part = 0; part < strips.parts.size(); ++part) {
    canvas.rectangle({legend_x, y, 12, 10}, color_of(part));
    canvas.text(legend_x + 17, y + 9, strips.parts[part], 11, Anchor::start);
    legend_x += 36 + text_width(strips.parts[part], 11);
  }
  y += 24;
  const double left = 30 + name_width;
  const double length = strips.width - left - whole_width - 30;
  for (const Strips::Row& row : strips.rows) {
    canvas.text(left - 10, y + kStrip / 2 + 4, row.name, kTextSize, Anchor::end);
    const double sum = std::accumulate(row.values.begin(), row.values.end(), 0.0);
    double x = left;
    for (std::size_t part = 0; part < row.values.size() && sum > 0; ++part) {
      const double wide = length * row.values[part] / sum;
      canvas.rectangle({x, y, wide, kStrip}, color_of(part));
      const std::string share = std::to_string(std::lround(100 * row.values[part] / sum)) + " %";
      if (text_width(share, kShareSize) + 6 < wide)
        canvas.text(x + wide / 2, y + kStrip / 2 + 4, share, kShareSize, Anchor::middle, kPaper);
      x += wide;
    }
    canvas.text(left + length + 10, y + kStrip / 2 + 4, row.whole, kTextSize, Anchor::start);
    y += kRow;
  }
  return std::move(canvas).finish();
}

}  // namespace collided::draw
