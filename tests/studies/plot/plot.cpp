#include "tests/studies/plot/plot.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/plot/axis_map.hpp"

namespace collided::draw {
namespace {

constexpr double kTextSize = 12;
constexpr double kLabelSize = 10.5;
constexpr double kLegendWidth = 215;

struct Style {
  const char* color = kInk;
  int shape = 0;
};

/// The style of each series: the accent for this project's, else a colour of the palette together with a shape, so that
/// series can be distinguished by either alone.
std::vector<Style> styles(const std::vector<Series>& series) {
  std::vector<Style> result;
  int next = 0;
  int ours = 0;
  for (const Series& s : series) {
    if (s.paint == Paint::accent) {
      result.push_back({kAccent, ours++});
    } else if (s.paint == Paint::quiet) {
      result.push_back({kQuiet, 5});
    } else {
      result.push_back({kPalette[next % kPaletteSize], next + 1 + next / kPaletteSize});
      ++next;
    }
  }
  return result;
}

/// Marks a line, as a chain of small squares, as a place that labels must avoid.
void occupy_segment(Canvas& canvas, std::pair<double, double> a, std::pair<double, double> b) {
  const int steps = 1 + static_cast<int>(std::hypot(b.first - a.first, b.second - a.second) / 4);
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    canvas.occupy({a.first + part * (b.first - a.first) - 1.5, a.second + part * (b.second - a.second) - 1.5, 3, 3});
  }
}

class Frame {
 public:
  Frame(Canvas& canvas, const Plot& plot, double top)
      : canvas_(canvas),
        area_{78, top, plot.width - 78 - kLegendWidth - 18, plot.height - top - 58},
        x_(plot.x, values(plot, true), area_.x, area_.x + area_.width),
        y_(plot.y, values(plot, false), area_.y + area_.height, area_.y) {}

  void draw_axes(const Plot& plot) {
    const double bottom = area_.y + area_.height;
    double free_from = -1e9;
    for (const auto& [value, name] : x_.ticks(62)) {
      const double px = x_.pixel(value);
      canvas_.line(px, area_.y, px, bottom, kFaint, 0.8);
      const double half = text_width(name, kTextSize) / 2;
      if (px - half < free_from) continue;
      canvas_.text(px, bottom + 17, name, kTextSize, Anchor::middle);
      free_from = px + half + 6;
    }
    for (const auto& [value, name] : y_.ticks(30)) {
      const double py = y_.pixel(value);
      canvas_.line(area_.x, py, area_.x + area_.width, py, kFaint, 0.8);
      canvas_.text(area_.x - 7, py + 4, name, kTextSize, Anchor::end);
    }
    canvas_.line(area_.x, bottom, area_.x + area_.width, bottom, kInk, 1.2);
    canvas_.line(area_.x, area_.y, area_.x, bottom, kInk, 1.2);
    canvas_.text(area_.x + area_.width / 2, bottom + 42, plot.x.label, kTextSize, Anchor::middle);
    canvas_.vertical_text(17, area_.y + area_.height / 2, plot.y.label, kTextSize);
  }

  std::pair<double, double> place(const Point& p) const { return {x_.pixel(p.x), y_.pixel(p.y)}; }

  void draw_series(const Series& series, const Style& style) {
    std::vector<std::pair<double, double>> path;
    for (const Point& p : series.points) path.push_back(place(p));
    if (series.joined) {
      canvas_.polyline(path, style.color, series.paint == Paint::accent ? 2.0 : 1.5, series.dashed ? "6 4" : nullptr);
      for (std::size_t i = 1; i < path.size(); ++i) occupy_segment(canvas_, path[i - 1], path[i]);
    }
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Point& p = series.points[i];
      if (p.x_high > p.x_low) {
        const double low = x_.pixel(p.x_low);
        const double high = x_.pixel(p.x_high);
        canvas_.line(low, path[i].second, high, path[i].second, style.color, 1);
        occupy_segment(canvas_, {low, path[i].second}, {high, path[i].second});
      }
      if (series.marked) canvas_.mark(path[i].first, path[i].second, style.shape, style.color, series.hollow);
    }
  }

  /// Draws a label at the nearest free place: beside the mark, else farther away with a line to it.
  void draw_label(const Point& p, const Style& style) {
    const auto [x, y] = place(p);
    const double width = text_width(p.label, kLabelSize);
    for (int ring = 0; ring < 9; ++ring) {
      const double out = 9 + 11 * ring;
      for (int turn = 0; turn < 16; ++turn) {
        const double angle = 2 * 3.14159265358979 * turn / 16 - 0.4;
        const double dx = out * std::cos(angle);
        const double dy = out * std::sin(angle);
        const Anchor anchor = std::abs(dx) < 4 ? Anchor::middle : dx > 0 ? Anchor::start : Anchor::end;
        const double text_y = y + dy + 0.3 * kLabelSize;
        Rectangle box = text_box(x + dx, text_y, p.label, kLabelSize, anchor);
        box = {box.x - 1.5, box.y - 1, width + 3, box.height + 2};
        if (!area_.contains(box) || !canvas_.is_free(box)) continue;
        if (ring > 0) canvas_.line(x, y, x + dx, y + dy, kQuiet, 0.6);
        canvas_.text(x + dx, text_y, p.label, kLabelSize, anchor, style.color);
        return;
      }
    }
  }

  double legend_x() const { return area_.x + area_.width + 18; }
  double top() const { return area_.y; }

 private:
  static std::vector<double> values(const Plot& plot, bool of_x) {
    std::vector<double> all;
    for (const Series& series : plot.series) {
      for (const Point& p : series.points) {
        all.push_back(of_x ? p.x : p.y);
        if (of_x && p.x_high > p.x_low) all.insert(all.end(), {p.x_low, p.x_high});
      }
    }
    return all;
  }

  Canvas& canvas_;
  Rectangle area_;
  AxisMap x_;
  AxisMap y_;
};

void draw_legend(Canvas& canvas, const Plot& plot, const std::vector<Style>& style, double x, double y) {
  y += 6;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    if (series.name.empty()) continue;
    if (series.joined) canvas.line(x, y, x + 22, y, style[i].color, 1.6, series.dashed ? "6 4" : nullptr);
    if (series.marked) canvas.mark(x + 11, y, style[i].shape, style[i].color, series.hollow);
    const std::string name = series.points.empty() ? series.name + " (no data)" : series.name;
    for (const std::string& line : wrapped(name, 11, kLegendWidth - 32)) {
      canvas.text(x + 29, y + 4, line, 11, Anchor::start, series.paint == Paint::accent ? kAccent : kInk);
      y += 14.5;
    }
    y += 6;
  }
}

}  // namespace

std::string svg(const Plot& plot) {
  Canvas canvas(plot.width, plot.height, plot.title);
  Frame frame(canvas, plot, draw_title(canvas, plot.title));
  const std::vector<Style> style = styles(plot.series);
  frame.draw_axes(plot);
  draw_legend(canvas, plot, style, frame.legend_x(), frame.top());
  // This project's series come last, so that they are on top.
  for (const bool ours : {false, true}) {
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
      if ((plot.series[i].paint == Paint::accent) == ours) frame.draw_series(plot.series[i], style[i]);
    }
  }
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    for (const Point& p : plot.series[i].points) {
      if (!p.label.empty()) frame.draw_label(p, style[i]);
    }
  }
  return std::move(canvas).finish();
}

}  // namespace collided::draw
