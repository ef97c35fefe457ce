#include "tests/studies/report/figures/figures.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/plot/plot.hpp"

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

/// Errors are fractions of the motion.
bool is_of_time(const Row& row) { return row.study == "time" || row.study == "turning"; }

std::string asked_label(const Row& row) { return row.label.starts_with("width") ? row.label : "asked " + row.label; }

/// Worst error against time, both logarithmic; a line a series, a point a row.
draw::Plot work_precision(const std::string& title, const std::vector<Row>& rows) {
  draw::Plot plot{
      .title = title,
      .x = {.label = "time a question, ns (median; bar: range of the repeats)", .scale = Scale::logarithmic},
      .y = {.label = is_of_time(rows.front()) ? "worst error, steps" : "worst relative error",
            .scale = Scale::logarithmic}};
  double labelled_bound = INFINITY;
  draw::Series bounds{.name = "ours: proved bound, worst", .paint = Paint::quiet, .joined = false, .hollow = true};
  for (const Row& row : rows) {
    const bool asked = row.series.ends_with("asked");
    if (!std::isnan(row.bound_max) && !std::isnan(row.ns)) {
      // What was asked for shows in the bound; where asking for more changes nothing, it is not said again.
      const bool says_more = asked && !(row.bound_max > labelled_bound / 3);
      if (says_more) labelled_bound = row.bound_max;
      bounds.points.push_back({row.ns, row.bound_max, says_more ? asked_label(row) : ""});
    }
    auto series =
        std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& s) { return s.name == row.series; });
    if (series == plot.series.end()) {
      plot.series.push_back({.name = row.series,
                             .paint = is_ours(row.series) ? Paint::accent : Paint::palette,
                             .joined = asked,
                             .dashed = asked,
                             .hollow = row.series == "ours: uncertified"});
      series = plot.series.end() - 1;
    }
    if (std::isnan(row.ns) || std::isnan(row.error_max)) continue;
    series->points.push_back({row.ns, row.error_max, asked ? "" : point_label(row), row.ns_low, row.ns_high});
  }
  if (!bounds.points.empty()) plot.series.push_back(bounds);
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

std::vector<Figure> work_precision_figures(const std::vector<Row>& rows) {
  return {
      work_precision_figure(
          rows, "ray", "Ray, closest hit",
          "Distance along the ray of the closest hit, rays from around the mesh through it. Every method of ours walks "
          "the same tree; an error near 1 is a hit on another surface. Wrong yes or no is counted beside the point."),
      work_precision_figure(rows, "ray_hard", "Rays at vertices, edges and along faces",
                            "The same query where it is hard: a third of the rays aimed at vertices, a third at edges, "
                            "a third along a face at 1e-6 rad."),
      work_precision_figure(rows, "sphere_overlap", "Sphere overlap: depth in a triangle",
                            "Whether sphere and triangle share a point, and how deep."),
      work_precision_figure(rows, "box_overlap", "Box overlap: depth in a triangle",
                            "Whether box and triangle share a point, and the shortest translation that parts them."),
      work_precision_figure(
          rows, "nearest", "Nearest distance in a mesh",
          "Distance of points (a millionth to one size away from the surface) to the nearest triangle."),
      work_precision_figure(rows, "time", "Time of contact",
                            "First time at which a moving sphere meets a triangle. The error is in steps (absolute); "
                            "a cross is the proved bound, with the width of bracket that was asked for beside it."),
      work_precision_figure(rows, "turning", "Time of contact while turning",
                            "First time at which a box that turns as it flies meets a ball, beside testing so many "
                            "poses one after the other. The error is in pieces of motion (absolute); a cross is the "
                            "proved bound, with the width of bracket that was asked for beside it."),
      work_precision_figure(rows, "pair_depth", "Pair contact: depth of two boxes",
                            "Whether two turned boxes share a point, and the shortest translation that parts them."),
  };
}

std::vector<Row> of_study(const std::vector<Row>& rows, const std::string& study) {
  std::vector<Row> result;
  for (const Row& row : rows) {
    if (row.study == study) result.push_back(row);
  }
  return result;
}

std::vector<Figure> figures(const Tables& tables) {
  std::vector<Figure> result = work_precision_figures(tables.rows);
  for (const auto& more :
       {level_figures(tables.rows), index_figures(tables.rows), growth_figures(tables.rows), stage_figures(tables.rows),
        arrival_figures(tables.rows), response_figures(tables.response), contact_figures(tables.contact),
        map_figures(tables.rows), decision_figures(tables.rows, tables.census), pair_figures(tables.pairs)}) {
    result.insert(result.end(), more.begin(), more.end());
  }
  result.push_back(mutant_figure(tables.mutants));
  return result;
}

}  // namespace collided::report
