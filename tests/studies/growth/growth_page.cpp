#include "tests/studies/growth/growth_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "client/draw/svg.hpp"
#include "tests/studies/plot/plot.hpp"

namespace collided::growth {
namespace {

std::vector<std::string> knobs_of(const std::vector<Law>& laws) {
  std::vector<std::string> knobs;
  for (const Law& law : laws) {
    if (std::find(knobs.begin(), knobs.end(), law.knob) == knobs.end()) knobs.push_back(law.knob);
  }
  return knobs;
}

/// Each line in its own unit, over its value at the smallest size: what is compared is how steep they are.
std::string plot_of(const std::vector<Law>& laws, const std::string& knob) {
  draw::Plot plot{.title = "Growth with " + knob,
                  .x = {.label = knob, .scale = draw::Scale::logarithmic},
                  .y = {.label = "times as much as at the smallest size", .scale = draw::Scale::logarithmic}};
  for (const Law& law : laws) {
    if (law.knob != knob || law.samples.empty()) continue;
    draw::Series series{.name = law.what};
    for (const Sample& sample : law.samples)
      series.points.push_back({.x = sample.x, .y = sample.median / law.samples.front().median});
    plot.series.push_back(std::move(series));
  }
  return draw::svg(plot);
}

std::string rows_of(const std::vector<Law>& laws, const std::string& knob) {
  std::string html = "<table><thead><tr><th>what</th><th>" + knob +
                     "</th><th>median</th><th>least</th><th>most</th><th>unit</th></tr></thead><tbody>\n";
  for (const Law& law : laws) {
    if (law.knob != knob) continue;
    for (const Sample& s : law.samples) {
      html += fmt::format(
          "<tr><td class=\"t\">{}</td><td>{:.0f}</td><td>{:.4g}</td><td>{:.4g}</td><td>{:.4g}</td>"
          "<td class=\"t\">{}</td></tr>\n",
          draw::escaped(law.what), s.x, s.median, s.low, s.high, law.unit);
    }
  }
  return html + "</tbody></table>\n";
}

}  // namespace

std::vector<report::Figure> growth_figures(const std::vector<Law>& laws) {
  std::vector<report::Figure> figures{
      {.id = "laws",
       .title = "How it grows, and what theory says",
       .caption =
           fmt::format("Exponents by least squares on logarithms, with the spread of 95 % confidence. A law is "
                       "judged on the upper half of its decades; more than {} off that is not the fit's own "
                       "spread is named. Theory's exponent is what the fit finds in exact data at the same sizes.",
                       kTolerance),
       .body = "<pre>" + draw::escaped(table(laws)) + "</pre>"}};
  for (const std::string& knob : knobs_of(laws)) {
    figures.push_back({.id = knob,
                       .title = "Growth with " + knob,
                       .caption = "Medians of repeated runs, over the smallest size's.",
                       .body = plot_of(laws, knob),
                       .rows = rows_of(laws, knob)});
  }
  return figures;
}

void write_samples(const std::filesystem::path& file, const std::vector<Law>& laws, const report::Provenance& from) {
  std::ofstream out(file);
  out << "knob,what,unit,x,median,low,high,theory,seed,machine,commit\n";
  for (const Law& law : laws) {
    for (const Sample& s : law.samples) {
      out << fmt::format("{},\"{}\",{},{},{},{},{},{},{},\"{}\",{}\n", law.knob, law.what, law.unit, s.x, s.median,
                         s.low, s.high, law.theory.text(), from.seed, from.machine, from.commit);
    }
  }
}

}  // namespace collided::growth
