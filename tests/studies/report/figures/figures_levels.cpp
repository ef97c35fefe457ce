#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

using draw::Paint;
using draw::Scale;

double bound_of(const Row& row) { return row.bound_ratio > 0 ? row.error_max / row.bound_ratio : 0; }

/// The observed error with the proved bound above it, a point a level; triangles beside the points.
Figure level_figure(const std::vector<Row>& all, const std::string& study, const std::string& title,
                    const std::string& what) {
  const std::vector<Row> rows = of_study(all, study);
  Figure figure{study, title, what, ""};
  if (rows.empty()) return figure;
  draw::Plot plot{
      .title = title,
      .x = {.label = "time a question, ns (median; bar: range of the repeats)", .scale = Scale::logarithmic},
      .y = {.label = "error of a distance, m", .scale = Scale::logarithmic}};
  draw::Series seen{.name = "worst observed error; beside it the triangles", .paint = Paint::accent};
  draw::Series bound{.name = "proved bound", .dashed = true, .hollow = true};
  draw::Series closed{.name = "the sphere itself, closed form (its bound)", .paint = Paint::palette, .joined = false};
  for (const Row& row : rows) {
    if (row.series != "ours") {
      closed.points.push_back({row.ns, row.error_max, row.label});
      continue;
    }
    seen.points.push_back({row.ns, row.error_max, short_number(row.knob, 3), row.ns_low, row.ns_high});
    bound.points.push_back({row.ns, bound_of(row)});
  }
  plot.series = {seen, bound};
  if (!closed.points.empty()) plot.series.push_back(closed);
  figure.body = draw::svg(plot);
  figure.caption += " " + rows.front().scene + ", n = " + std::to_string(rows.front().n) + " a level.";
  figure.rows = rows_table(rows);
  return figure;
}

/// The proved bound of each level over its triangles, a line a cost.
Figure cost_figure(const std::vector<Row>& all) {
  Figure figure{
      "simplification-costs", "Two costs of a collapse",
      "How far a level is from the whole mesh at most, proved, over its triangles: edges collapsed by how far the "
      "vertex "
      "ends from the planes it stood for (quadric), and by how far it goes (edge length). The same guards for both.",
      ""};
  draw::Plot plot{.title = "Two costs of a collapse",
                  .x = {.label = "triangles", .scale = Scale::logarithmic},
                  .y = {.label = "proved distance of the two surfaces, m", .scale = Scale::logarithmic}};
  std::vector<Row> both;
  for (const auto& [study, name] :
       {std::pair{"simplification", "quadric"}, std::pair{"simplification by length", "edge length"}}) {
    draw::Series series{.name = name, .paint = both.empty() ? Paint::accent : Paint::palette};
    for (Row row : of_study(all, study)) {
      if (bound_of(row) > 0) series.points.push_back({row.knob, bound_of(row)});
      row.series = name;
      both.push_back(row);
    }
    if (!series.points.empty()) plot.series.push_back(series);
  }
  if (both.empty()) return figure;
  figure.body = draw::svg(plot);
  figure.caption += " " + both.front().scene + ".";
  figure.rows = rows_table(both);
  return figure;
}

}  // namespace

std::vector<Figure> level_figures(const std::vector<Row>& rows) {
  return {
      level_figure(rows, "simplification", "Simplification levels",
                   "Nearest distances asked of simpler and simpler meshes (full, 1/2, 1/4, ...; quadric error) "
                   "against those of the whole mesh. The bound is a two-sided Hausdorff distance, proved by "
                   "subdivision: no answer can be off by more."),
      cost_figure(rows),
      level_figure(rows, "tessellation", "Tessellation levels of a sphere",
                   "Distances to icospheres of 20, 80, 320, ... triangles against the analytic sphere. The bound is "
                   "the depth to which the faces cut into the sphere.")};
}

}  // namespace collided::report
