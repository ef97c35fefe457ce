#include "tests/studies/plot/plot.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

void add(draw::Plot& plot, const std::vector<Row>& rows, const std::string& series, const std::string& name,
         draw::Paint paint, long Row::*count) {
  draw::Series line{.name = name, .paint = paint};
  for (const Row& row : rows) {
    if (row.series == series && row.n > 0)
      line.points.push_back({row.knob, 100.0 * static_cast<double>(row.*count) / static_cast<double>(row.n)});
  }
  plot.series.push_back(line);
}

}  // namespace

std::vector<Figure> arrival_figures(const std::vector<Row>& all) {
  Figure figure{
      "arrival", "Events against arrival",
      "Crossings of two balls, each posed at 100 Hz by a publisher of its own, by how far the second one's instants "
      "lie "
      "behind the first one's. Who looks at each new pose against the other's last one misses crossings, and tells of "
      "others that never were; the truth follows from the pose lists in rationals. ",
      ""};
  const std::vector<Row> rows = of_study(all, "arrival");
  if (rows.empty()) return {figure};
  draw::Plot plot{
      .title = "Crossings missed and invented", .x = {.label = "phase, ms"}, .y = {.label = "% of the crossings"}};
  add(plot, rows, "collided", "collided: missed", draw::Paint::accent, &Row::missed);
  add(plot, rows, "against the last pose", "against the last pose: missed", draw::Paint::palette, &Row::missed);
  add(plot, rows, "against the last pose", "against the last pose: invented", draw::Paint::palette, &Row::false_hits);
  long lies = 0, told = 0;
  for (const Row& row : rows) {
    if (row.series != "collided") continue;
    lies += row.missed + row.false_hits;
    told += row.n;
  }
  figure.caption += "Ours: " + std::to_string(lies) + " missed or invented of " + std::to_string(told) + ".";
  figure.body = draw::svg(plot) + rows_table(rows);
  return {figure};
}

}  // namespace collided::report
