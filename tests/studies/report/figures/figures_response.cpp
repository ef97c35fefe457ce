#include <algorithm>
#include <cmath>
#include <map>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

using draw::Paint;
using draw::Scale;

Paint paint_of(const std::string& method) { return method == "compliant" ? Paint::accent : Paint::palette; }

draw::Series& series_of(draw::Plot& plot, const std::string& method) {
  for (draw::Series& series : plot.series) {
    if (series.name == method) return series;
  }
  plot.series.push_back({.name = method, .paint = paint_of(method)});
  return plot.series.back();
}

/// kappa = k dt^2 / m on x, whichever of its names the column has.
double stiffness_ratio(const Csv& csv, std::size_t row) {
  const double ratio = csv.number(row, "k*dt^2/m");
  return std::isnan(ratio) ? csv.number(row, "stiffness_ratio") : ratio;
}

bool exploded(const Csv& csv, std::size_t row) {
  const std::string text = csv.text(row, "exploded");
  return text == "1" || text == "true" || text == "yes";
}

/// Every method in the same order, so that it has the same colour in both figures.
void name_methods(draw::Plot& plot, const Csv& csv) {
  for (std::size_t i = 0; i < csv.rows.size(); ++i) series_of(plot, csv.text(i, "method"));
}

/// A method that has no place in a figure is not named there.
void finish(draw::Plot& plot) {
  for (draw::Series& series : plot.series) {
    std::stable_sort(series.points.begin(), series.points.end(),
                     [](const auto& a, const auto& b) { return a.x < b.x; });
    if (series.points.empty()) series.name.clear();
  }
}

/// The worst row for each place on x.
void add_worst(draw::Series& series, double x, double y) {
  for (draw::Point& p : series.points) {
    if (p.x == x) {
      p.y = std::max(p.y, y);
      return;
    }
  }
  series.points.push_back({x, y});
}

std::string csv_table(const Csv& csv) {
  std::string html = "<table><thead><tr>";
  for (const std::string& name : csv.header) html += "<th>" + name + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const auto& row : csv.rows) {
    html += "<tr>";
    for (const std::string& text : row) html += "<td>" + text + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

Figure stability(const Csv& csv) {
  Figure figure{
      "stiff", "Stability of stiff response",
      "Energy drift of each way to step a contact of stiffness k, against kappa = k dt^2 / m: the worst of all "
      "scenes and steps there. Explicit steps explode where their line leaves the frame at the top (drift above "
      "ten, drawn at 1e6); implicit ones do not. Rows of response_study.",
      ""};
  draw::Plot plot{.title = "Energy drift against stiffness",
                  .x = {.label = "kappa = k dt^2 / m", .scale = Scale::logarithmic},
                  .y = {.label = "energy drift, relative", .scale = Scale::logarithmic, .low = 1e-12, .high = 1e6}};
  name_methods(plot, csv);
  long used = 0;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    const double kappa = stiffness_ratio(csv, i);
    if (!std::isfinite(kappa) || !(kappa > 0)) continue;
    const double drift = std::abs(csv.number(i, "energy_drift"));
    const double shown = exploded(csv, i) || !std::isfinite(drift) ? 1e6 : std::clamp(drift, 1e-12, 1e6);
    add_worst(series_of(plot, csv.text(i, "method")), kappa, shown);
    ++used;
  }
  if (used == 0) return figure;
  finish(plot);
  figure.caption += " n = " + std::to_string(used) + " rows.";
  figure.body = draw::svg(plot);
  figure.rows = csv_table(csv);
  return figure;
}

Figure step_size(const Csv& csv) {
  Figure figure{
      "steps", "Step size of ways to step contacts",
      "Error of positions at the end against the reference, and the processor time of a simulated second; a point "
      "a step size (beside it, in seconds), the median over scenes and stiffnesses where the method did not "
      "explode. Rows of response_study.",
      ""};
  draw::Plot plot{.title = "Error against run time of ways to step contacts",
                  .x = {.label = "time of a simulated second, ns", .scale = Scale::logarithmic},
                  .y = {.label = "error of positions, m (median)", .scale = Scale::logarithmic}};
  name_methods(plot, csv);
  std::map<std::pair<std::string, double>, std::vector<std::pair<double, double>>> groups;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    const double dt = std::isnan(csv.number(i, "dt")) ? csv.number(i, "dt_s") : csv.number(i, "dt");
    const double error = csv.number(i, "error_m");
    const double ns = csv.number(i, "ns_per_step");
    if (!(dt > 0) || !std::isfinite(error) || !std::isfinite(ns) || exploded(csv, i)) continue;
    groups[{csv.text(i, "method"), dt}].push_back({ns / dt, error});
  }
  for (auto& [key, values] : groups) {
    std::vector<double> times;
    std::vector<double> errors;
    for (const auto& [time, error] : values) {
      times.push_back(time);
      errors.push_back(error);
    }
    std::sort(times.begin(), times.end());
    std::sort(errors.begin(), errors.end());
    series_of(plot, key.first)
        .points.push_back({times[times.size() / 2], errors[errors.size() / 2], short_number(key.second, 2)});
  }
  if (groups.empty()) return figure;
  finish(plot);
  figure.caption += " n = " + std::to_string(csv.rows.size()) + " rows.";
  figure.body = draw::svg(plot);
  return figure;
}

}  // namespace

std::vector<Figure> response_figures(const Csv& response) { return {step_size(response), stability(response)}; }

}  // namespace collided::report
