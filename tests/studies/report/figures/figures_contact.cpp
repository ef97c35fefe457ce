#include <algorithm>
#include <cmath>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

using draw::Paint;
using draw::Scale;

const std::pair<std::string, std::string> kMethods[]{{"explicit_euler", "explicit Euler"},
                                                     {"velocity_verlet", "velocity Verlet"},
                                                     {"implicit_euler", "implicit Euler"},
                                                     {"closed_form", "closed form (ours)"}};
constexpr double kStiffnesses[]{1e2, 1e7, 1e12};
constexpr double kLeastError = 1e-14;
constexpr double kMostError = 1e2;

std::string power_of_ten(double value) { return "1e" + std::to_string(std::lround(std::log10(value))); }

bool is_stiffness(const Csv& csv, std::size_t row, double stiffness) {
  return std::abs(csv.number(row, "stiffness_n_m") / stiffness - 1) < 1e-6;
}

/// One plot a stiffness, one line a method: its error over what `column` says of its steps.
std::string error_plots(const Csv& csv, const std::string& column, const std::string& label, double scale) {
  std::string svgs;
  for (const double stiffness : kStiffnesses) {
    draw::Plot plot{
        .title = "k = " + power_of_ten(stiffness) + " N/m",
        .x = {.label = label, .scale = Scale::logarithmic},
        .y = {.label = "error at the end", .scale = Scale::logarithmic, .low = kLeastError, .high = kMostError},
        .height = 330};
    for (const auto& [name, title] : kMethods) {
      draw::Series series{.name = title, .paint = name == "closed_form" ? Paint::accent : Paint::palette};
      for (std::size_t i = 0; i < csv.rows.size(); ++i) {
        if (csv.text(i, "integrator") != name || !is_stiffness(csv, i, stiffness)) continue;
        const double error = csv.number(i, "error");
        series.points.push_back({csv.number(i, column) * scale,
                                 std::clamp(std::isfinite(error) ? error : kMostError, kLeastError, kMostError)});
      }
      std::sort(series.points.begin(), series.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
      plot.series.push_back(std::move(series));
    }
    svgs += draw::svg(plot);
  }
  return svgs;
}

std::string table(const Csv& csv, bool spheres) {
  std::string html = "<table><thead><tr>";
  for (const std::string& name : csv.header) html += "<th>" + name + "</th>";
  html += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    if (spheres && csv.text(i, "integrator") != "spheres") continue;
    html += "<tr>";
    for (const std::string& text : csv.rows[i]) html += "<td>" + text + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

/// What is true of every figure of the study.
std::string scene_text(const Csv& csv) {
  return " Two spheres of 0.12 and 0.08 m, 0.5 to 2 m/s, up to 46 degrees aside, one frame of 1/60 s in which they "
         "touch; the worst of the "
         "seeded starts, times their median. The truth is found in long double by 20,000 Runge-Kutta steps a contact. "
         "response_study --contact, seed 1, 5 starts; n = " +
         std::to_string(csv.rows.size()) + " rows.";
}

Figure penetration(const Csv& csv) {
  Figure figure{"penetration", "How deep a spring is pressed",
                "Deepest penetration over v sqrt(m / k), which a spring without a damper has; 1 is right. Spheres as "
                "collide publish --spheres moves them, "
                "told of the touch after the frame in which it was, at three frame rates; beside them methods that "
                "step, with a step of a millisecond.",
                ""};
  draw::Plot plot{
      .title = "Penetration over v sqrt(m / k)",
      .x = {.label = "stiffness, N/m", .scale = Scale::logarithmic},
      .y = {.label = "penetration / (v sqrt(m / k))", .scale = Scale::logarithmic, .low = 1e-6, .high = 1e6}};
  for (const double rate_hz : {60.0, 120.0, 240.0}) {
    draw::Series series{.name = "spheres at " + std::to_string(std::lround(rate_hz)) + " Hz",
                        .paint = Paint::accent,
                        .hollow = rate_hz > 60};
    for (std::size_t i = 0; i < csv.rows.size(); ++i) {
      if (csv.text(i, "integrator") != "spheres" || std::abs(csv.number(i, "dt_s") * rate_hz - 1) > 1e-3) continue;
      series.points.push_back(
          {csv.number(i, "stiffness_n_m"), csv.number(i, "penetration_m") / csv.number(i, "law_m")});
    }
    plot.series.push_back(std::move(series));
  }
  for (const auto& [name, title] : kMethods) {
    if (name == "closed_form") continue;
    draw::Series series{.name = title + ", 1 ms"};
    for (std::size_t i = 0; i < csv.rows.size(); ++i) {
      if (csv.text(i, "integrator") != name || std::abs(csv.number(i, "dt_s") * 960 - 1) > 1e-3) continue;
      series.points.push_back(
          {csv.number(i, "stiffness_n_m"), std::max(1e-6, csv.number(i, "penetration_m") / csv.number(i, "law_m"))});
    }
    plot.series.push_back(std::move(series));
  }
  figure.caption += scene_text(csv);
  figure.body = draw::svg(plot);
  figure.rows = table(csv, true);
  return figure;
}

}  // namespace

std::vector<Figure> contact_figures(const Csv& csv) {
  Figure by_step{"contact_steps", "Error of a contact against the step",
                 "Error of place (over the length of the spring) or of velocity (over itself), whichever is larger, at "
                 "the end of the frame, against the step. A method that "
                 "steps is right only where its step is below the contact, which lasts pi sqrt(m / k); errors above "
                 "100 are drawn there.",
                 ""};
  Figure by_time{"contact_times", "Error of a contact against run time",
                 "The same errors against the processor time of the frame.", ""};
  if (csv.rows.empty())
    return {Figure{"penetration", "How deep a spring is pressed", "Penetration by stiffness.", ""}, by_step, by_time};
  by_step.caption += scene_text(csv);
  by_step.body = error_plots(csv, "dt_s", "step, s", 1);
  by_step.rows = table(csv, false);
  by_time.caption += scene_text(csv);
  by_time.body = error_plots(csv, "ns", "time of the frame, us", 1e-3);
  return {penetration(csv), by_step, by_time};
}

}  // namespace collided::report
