#include <cmath>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

using draw::Scale;

/// Of the least-squares line through the logarithms.
double slope(const std::vector<Row>& rows) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Row& row : rows) {
    const double x = std::log(row.knob);
    const double y = std::log(row.ns);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

draw::Plot over_knob(const std::string& scene, const std::string& what, const std::vector<Row>& rows) {
  draw::Plot plot{.title = what + " against " + scene,
                  .x = {.label = scene, .scale = Scale::logarithmic},
                  .y = {.label = what + ", ns", .scale = Scale::logarithmic}};
  plot.series.push_back({.name = "collided", .paint = draw::Paint::accent});
  for (const Row& row : rows) plot.series.back().points.push_back({row.knob, row.ns});
  return plot;
}

}  // namespace

std::vector<Figure> growth_figures(const std::vector<Row>& all) {
  Figure figure{
      "growth", "How cost grows",
      "Wall time of a ray (first hit on a terrain, decided exactly, through the whole question path) and, for "
      "moving objects, of one object's share of a frame: grid rebuilt and all overlapping pairs. ",
      ""};
  for (const auto& [scene, what] : {std::pair<std::string, std::string>{"triangles", "a ray"},
                                    {"rays a batch", "a ray"},
                                    {"threads", "a ray"},
                                    {"moving objects", "an object and frame"}}) {
    std::vector<Row> rows;
    long missed = 0;
    for (const Row& row : of_study(all, "growth")) {
      if (row.scene != scene) continue;
      rows.push_back(row);
      missed += row.missed;
    }
    if (rows.size() < 2) continue;
    figure.body += draw::svg(over_knob(scene, what, rows)) + rows_table(rows);
    figure.caption += "Against " + scene + " the slope on log-log axes is " + short_number(slope(rows), 2) + "; " +
                      std::to_string(missed) + " answers differ from those asked one by one. ";
  }
  return {figure};
}

}  // namespace collided::report
