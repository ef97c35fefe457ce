#include "tests/report/figures.hpp"

#include <algorithm>
#include <cmath>

#include "client/draw/plot.hpp"

namespace collided::report {
namespace {

using draw::Paint;
using draw::Scale;

bool is_ours(const std::string& series) { return series.starts_with("ours"); }

std::string point_label(const Row& row) {
  std::string label = row.label;
  const long wrong = row.missed + row.false_hits;
  if (wrong > 0) label += " (" + std::to_string(wrong) + " wrong)";
  if (row.undecided > 0) label += " (" + std::to_string(row.undecided) + " undecided)";
  return label;
}

/// Worst error against time, both logarithmic; a line a series, a point a row.
draw::Plot work_precision(const std::string& title, const std::vector<Row>& rows) {
  draw::Plot plot{.title = title,
                  .x = {.label = "time a question, ns (median; bar: range of the repeats)", .scale = Scale::logarithmic},
                  .y = {.label = "worst relative error", .scale = Scale::logarithmic}};
  for (const Row& row : rows) {
    auto series = std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& s) { return s.name == row.series; });
    if (series == plot.series.end()) {
      const bool asked = row.series == "ours: error asked";
      plot.series.push_back({.name = row.series, .paint = is_ours(row.series) ? Paint::accent : Paint::palette,
                             .joined = asked, .dashed = asked, .hollow = row.series == "ours: uncertified"});
      series = plot.series.end() - 1;
    }
    if (std::isnan(row.ns) || std::isnan(row.error_max)) continue;
    series->points.push_back({row.ns, row.error_max, point_label(row), row.ns_low, row.ns_high});
  }
  return plot;
}

std::string questions_text(const std::vector<Row>& rows) {
  if (rows.empty()) return "";
  return rows.front().scene + ", n = " + std::to_string(rows.front().n) + ".";
}

Figure work_precision_figure(const std::vector<Row>& all, const std::string& study, const std::string& title,
                             const std::string& what) {
  const std::vector<Row> rows = of_study(all, study);
  Figure figure{study, title, what + " " + questions_text(rows), ""};
  if (rows.empty()) return figure;
  figure.body = draw::svg(work_precision(title, rows));
  figure.rows = rows_table(rows);
  return figure;
}

}  // namespace

std::vector<Row> of_study(const std::vector<Row>& rows, const std::string& study) {
  std::vector<Row> result;
  for (const Row& row : rows) {
    if (row.study == study) result.push_back(row);
  }
  return result;
}

std::vector<Figure> figures(const std::vector<Row>& rows, const std::string&, const std::string&) {
  std::vector<Figure> result;
  result.push_back(work_precision_figure(
      rows, "ray", "Closest hit of a ray: error against run time",
      "Distance along the ray of the closest hit, rays from around the mesh through it; every method of ours walks the same tree. "
      "Errors of right decisions only; wrong yes or no counted beside the point."));
  result.push_back(work_precision_figure(
      rows, "ray_hard", "Rays at vertices, edges and along faces: error against run time",
      "The same query where it is hard: a third of the rays aimed at vertices, a third at edges, a third at 1e-6 rad along a face."));
  return result;
}

}  // namespace collided::report
