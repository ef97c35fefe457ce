#include <cmath>
#include <cstdlib>

#include "client/draw/plot.hpp"
#include "tests/report/figures.hpp"

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

}  // namespace

std::vector<Figure> level_figures(const std::vector<Row>& rows) {
  return {
      level_figure(rows, "simplification", "Simplification levels",
                   "Nearest distances asked of simpler and simpler meshes (full, 1/2, 1/4, ...; quadric error) "
                   "against those of the whole mesh. The bound is a two-sided Hausdorff distance, proved by "
                   "subdivision: no answer can be off by more."),
      level_figure(rows, "tessellation", "Tessellation levels of a sphere",
                   "Distances to icospheres of 20, 80, 320, ... triangles against the analytic sphere. The bound is "
                   "the depth to which the faces cut into the sphere.")};
}

}  // namespace collided::report
