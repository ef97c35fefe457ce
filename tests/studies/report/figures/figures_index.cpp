#include <algorithm>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

using draw::Paint;
using draw::Scale;

draw::Plot over_triangles(const std::string& title, const std::string& what, const std::vector<Row>& rows,
                          double Row::*value) {
  draw::Plot plot{.title = title,
                  .x = {.label = "triangles", .scale = Scale::logarithmic},
                  .y = {.label = what, .scale = Scale::logarithmic}};
  for (const Row& row : rows) {
    auto series =
        std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& s) { return s.name == row.series; });
    if (series == plot.series.end()) {
      plot.series.push_back({.name = row.series,
                             .paint = row.series.starts_with("ours") ? Paint::accent : Paint::palette,
                             .dashed = row.series.ends_with("polygons")});
      series = plot.series.end() - 1;
    }
    series->points.push_back({row.knob, row.*value});
  }
  return plot;
}

Figure index_figure(const std::vector<Row>& all, const std::string& id, const std::string& scene,
                    const std::string& what) {
  std::vector<Row> rows;
  for (const Row& row : of_study(all, "index")) {
    if (row.scene == scene) rows.push_back(row);
  }
  Figure figure{id, "The index and the plain forms: " + scene, what, ""};
  if (rows.empty()) return figure;
  long unequal = 0;
  for (const Row& row : rows) unequal += row.missed;
  figure.body = draw::svg(over_triangles("Time", "time a ray, ns", rows, &Row::ns)) +
                draw::svg(over_triangles("Nodes", "nodes a ray visits", rows, &Row::nodes)) + rows_table(rows);
  figure.caption += " n = " + std::to_string(rows.front().n) + " rays a size; " + std::to_string(unequal) +
                    " answers differ from those of brute force.";
  return figure;
}

}  // namespace

std::vector<Figure> index_figures(const std::vector<Row>& rows) {
  const std::string what =
      "First hit along a ray, every candidate decided exactly, through three indexes: ours (eight children, leaves of "
      "eight), planes across the axes until a cell meets three triangles, and planes along the triangles themselves. "
      "A triangle on both sides of a plane is referred to from both; nothing is clipped.";
  return {index_figure(rows, "index_terrain", "terrain", what),
          index_figure(rows, "index_loose", "loose triangles",
                       what + " Here triangles are as large as the gaps between them.")};
}

}  // namespace collided::report
