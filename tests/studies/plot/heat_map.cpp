#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"

namespace collided::draw {
namespace {

constexpr double kTextSize = 11;

/// A colour from that of the paper to dark blue. Lightness falls evenly, so that the order is visible without colour
/// too.
std::string shade(double part) {
  part = std::clamp(part, 0.0, 1.0);
  const auto mix = [part](int from, int to) { return static_cast<int>(std::lround(from + part * (to - from))); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", mix(0xf4, 0x08), mix(0xf1, 0x30), mix(0xe8, 0x6b));
  return text;
}

double part_of(const HeatMap& map, double value) {
  return value <= map.low ? 0 : std::log(value / map.low) / std::log(map.high / map.low);
}

void draw_cell(Canvas& canvas, const HeatMap::Cell& cell, const Rectangle& box, const HeatMap& map) {
  if (!cell.value) {
    canvas.rectangle(box, kPaper, kFaint);
    for (double x = 6; x < box.width + box.height; x += 9) {
      const double x0 = box.x + std::min(x, box.width);
      const double y0 = box.y + std::max(0.0, x - box.width);
      const double x1 = box.x + std::max(0.0, x - box.height);
      const double y1 = box.y + std::min(x, box.height);
      canvas.line(x0, y0, x1, y1, kFaint, 0.7);
    }
    return;
  }
  const double part = part_of(map, *cell.value);
  canvas.rectangle(box, shade(part).c_str(), kPaper);
  const bool fits = text_width(cell.text, 9.5) <= box.width - 2;
  if (fits)
    canvas.text(box.x + box.width / 2, box.y + box.height / 2 + 3.5, cell.text, 9.5, Anchor::middle,
                part > 0.55 ? kPaper : kInk);
}

void draw_legend(Canvas& canvas, const HeatMap& map, double x, double y) {
  constexpr int kSteps = 40;
  for (int i = 0; i < kSteps; ++i) canvas.rectangle({x + 6.0 * i, y, 6.2, 11}, shade((i + 0.5) / kSteps).c_str());
  canvas.text(x, y + 25, "<= " + tick_text(map.low), kTextSize, Anchor::start);
  canvas.text(x + 6.0 * kSteps, y + 25, ">= " + tick_text(map.high), kTextSize, Anchor::end);
  canvas.text(x + 6.0 * kSteps + 14, y + 10, map.legend, kTextSize, Anchor::start);
}

}  // namespace

std::string svg(const HeatMap& map) {
  constexpr double kRow = 25;
  double name_width = 40;
  for (const std::string& name : map.rows) name_width = std::max(name_width, text_width(name, kTextSize));
  const std::vector<std::string> title = wrapped(map.title, 15, map.width - 40);
  const double top = 44 + 20 * static_cast<double>(title.size());
  const double height = top + kRow * static_cast<double>(map.rows.size());
  Canvas canvas(map.width, height + 105, map.title);
  draw_title(canvas, map.title);
  const double left = 20 + name_width + 8;
  const double column = (map.width - 24 - left) / static_cast<double>(std::max<std::size_t>(1, map.columns.size()));
  canvas.text(left - 7, top - 7, map.y_label, kTextSize, Anchor::start);
  for (std::size_t row = 0; row < map.rows.size(); ++row) {
    const double y = top + kRow * static_cast<double>(row);
    canvas.text(left - 7, y + kRow / 2 + 4, map.rows[row], kTextSize, Anchor::end);
    for (std::size_t i = 0; i < map.columns.size(); ++i) {
      const std::size_t cell = row * map.columns.size() + i;
      const Rectangle box{left + column * static_cast<double>(i), y, column, kRow};
      draw_cell(canvas, cell < map.cells.size() ? map.cells[cell] : HeatMap::Cell{}, box, map);
    }
  }
  for (std::size_t i = 0; i < map.columns.size(); ++i) {
    canvas.text(left + column * (static_cast<double>(i) + 0.5), height + 16, map.columns[i], kTextSize, Anchor::middle);
  }
  canvas.text((left + map.width - 24) / 2, height + 38, map.x_label, kTextSize, Anchor::middle);
  draw_legend(canvas, map, left, height + 58);
  return std::move(canvas).finish();
}

}  // namespace collided::draw
