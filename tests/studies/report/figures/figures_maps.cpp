#include <algorithm>
#include <cmath>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

/// One map: offsets down, scales across; the worst error, or the share of wrong decisions where there are any.
std::string map_of(const std::vector<Row>& rows, const std::string& query, const std::string& series) {
  draw::HeatMap map{.title = query + ": " + series,
                    .x_label = "size of the shapes, m",
                    .y_label = "distance from the origin, sizes",
                    .low = 1e-16,
                    .high = 1,
                    .legend = "worst relative error; a dark cell with % : share of wrong yes or no"};
  std::vector<double> scales;
  for (const Row& row : rows) {
    if (row.scene != query || row.series != series) continue;
    if (std::find(scales.begin(), scales.end(), row.knob) == scales.end()) scales.push_back(row.knob);
    if (std::find(map.rows.begin(), map.rows.end(), row.label) == map.rows.end()) map.rows.push_back(row.label);
  }
  if (scales.empty()) return "";
  std::sort(scales.begin(), scales.end());
  for (const double scale : scales) map.columns.push_back(draw::tick_text(scale));
  map.cells.resize(map.rows.size() * scales.size());
  for (const Row& row : rows) {
    if (row.scene != query || row.series != series) continue;
    const auto line =
        static_cast<std::size_t>(std::find(map.rows.begin(), map.rows.end(), row.label) - map.rows.begin());
    const auto column = static_cast<std::size_t>(std::find(scales.begin(), scales.end(), row.knob) - scales.begin());
    draw::HeatMap::Cell& cell = map.cells[line * scales.size() + column];
    const long wrong = row.missed + row.false_hits + row.undecided;
    if (wrong > 0) {
      cell = {1.0, short_number(100.0 * static_cast<double>(wrong) / static_cast<double>(row.n)) + "%"};
    } else if (!std::isnan(row.error_max)) {
      cell = {row.error_max, short_number(row.error_max, 1)};
    }
  }
  return draw::svg(map);
}

Figure map_figure(const std::vector<Row>& rows, const std::string& query, const std::string& id,
                  const std::vector<std::string>& series, const std::string& what) {
  Figure figure{id, "Scale and offset: " + query, what, ""};
  long n = 0;
  for (const Row& row : rows) {
    if (row.scene == query && row.series == series.front()) n = std::max(n, row.n);
  }
  for (const std::string& one : series) figure.body += map_of(rows, query, one);
  figure.caption += " n = " + std::to_string(n) +
                    " questions a cell. The exact input is the doubles after the offset; float "
                    "programs round them once more, which is part of their error. A hatched cell has no data.";
  return figure;
}

}  // namespace

std::vector<Figure> map_figures(const std::vector<Row>& all) {
  const std::vector<Row> rows = of_study(all, "extremes");
  return {map_figure(rows, "ray", "map_ray", {"ours", "plain double", "Embree"},
                     "Closest hit of rays through an icosahedron."),
          map_figure(rows, "sphere overlap", "map_sphere", {"ours", "plain double", "plain float"},
                     "Yes or no and depth of spheres in triangles."),
          map_figure(rows, "nearest", "map_nearest", {"ours", "plain double", "plain float"},
                     "Distance of points to triangles."),
          map_figure(rows, "time of contact", "map_time", {"ours", "plain double", "plain float"},
                     "First time at which a moving sphere meets a triangle (error relative to that time).")};
}

}  // namespace collided::report
