#include <algorithm>

#include "tests/studies/plot/axis_map.hpp"
#include "tests/studies/plot/plot.hpp"

namespace collided::draw {
namespace {

constexpr double kTextSize = 12;
constexpr double kLabelSize = 10.5;

std::string amount(double value) { return value == 0 ? "0" : tick_text(value); }

}  // namespace

std::string svg(const Bars& bars) {
  constexpr double kBar = 13;
  const double row = kBar * static_cast<double>(bars.series.size()) + 14;
  double name_width = 60;
  for (const Bars::Group& group : bars.groups) name_width = std::max(name_width, text_width(group.name, kTextSize));
  std::vector<double> values;
  for (const Bars::Group& group : bars.groups) {
    for (const auto& value : group.values) values.push_back(value.value_or(0));
  }
  Canvas canvas(bars.width, 40 + row * static_cast<double>(bars.groups.size()) + 84, bars.title);
  double y = draw_title(canvas, bars.title);
  double legend_x = 20;
  for (std::size_t i = 0; i < bars.series.size(); ++i) {
    const char* color = i == 0 ? kAccent : kPalette[(i - 1) % kPaletteSize];
    canvas.rectangle({legend_x, y, 12, 10}, color);
    canvas.text(legend_x + 17, y + 9, bars.series[i], 11, Anchor::start);
    legend_x += 36 + text_width(bars.series[i], 11);
  }
  y += 24;
  const double left = 20 + name_width + 10;
  const AxisMap map(bars.value, values, left, bars.width - 110);
  const double bottom = y + row * static_cast<double>(bars.groups.size());
  for (const auto& [value, name] : map.ticks(62)) {
    canvas.line(map.pixel(value), y, map.pixel(value), bottom, kFaint, 0.8);
    canvas.text(map.pixel(value), bottom + 16, name, kTextSize, Anchor::middle);
  }
  for (const Bars::Group& group : bars.groups) {
    canvas.text(left - 8, y + row / 2 + 4, group.name, kTextSize, Anchor::end);
    for (std::size_t i = 0; i < group.values.size(); ++i) {
      const double bar_y = y + 7 + kBar * static_cast<double>(i);
      const char* color = i == 0 ? kAccent : kPalette[(i - 1) % kPaletteSize];
      if (!group.values[i]) {
        canvas.text(left + 5, bar_y + 10, "no data", kLabelSize, Anchor::start, kQuiet);
        continue;
      }
      const double end = map.pixel(*group.values[i]);
      canvas.rectangle({left, bar_y, std::max(1.5, end - left), kBar - 2}, color);
      canvas.text(std::max(left + 1.5, end) + 5, bar_y + 10, amount(*group.values[i]), kLabelSize, Anchor::start);
    }
    y += row;
  }
  canvas.line(left, y, left, y - row * static_cast<double>(bars.groups.size()), kInk, 1.2);
  canvas.text((left + bars.width - 110) / 2, y + 40, bars.value.label, kTextSize, Anchor::middle);
  return std::move(canvas).finish();
}

}  // namespace collided::draw
