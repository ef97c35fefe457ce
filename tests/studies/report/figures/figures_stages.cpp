#include <algorithm>

#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {

std::vector<Figure> stage_figures(const std::vector<Row>& all) {
  const std::vector<Row> rows = of_study(all, "stages");
  if (rows.empty()) return {};
  draw::Strips strips{.title = "What a step is made of"};
  for (const Row& row : rows) {
    if (std::find(strips.parts.begin(), strips.parts.end(), row.series) == strips.parts.end())
      strips.parts.push_back(row.series);
    if (strips.rows.empty() || strips.rows.back().name != row.scene) strips.rows.push_back({.name = row.scene});
    strips.rows.back().values.push_back(row.ns);
  }
  for (draw::Strips::Row& strip : strips.rows) {
    double sum = 0;
    for (const double ns : strip.values) sum += ns;
    strip.whole = short_number(sum * 1e-6, 3) + " ms";
  }
  Figure figure{"stages", "What a step is made of",
                "Every ball moves in every step: its pose is taken, bounds are made, the grid finds pairs, these are "
                "decided exactly, and "
                "what began or ended becomes events and a state to ask. Medians of the stages by themselves, so that "
                "they need not add up to "
                "the median of the whole.",
                draw::svg(strips) + rows_table(rows)};
  return {figure};
}

}  // namespace collided::report
