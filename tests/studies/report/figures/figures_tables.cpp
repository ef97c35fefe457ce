#include <algorithm>
#include <cmath>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

/// Counts as rows of one shape, whichever program made them.
struct Count {
  std::string family;
  std::string method;
  double per_million = 0;
};

std::vector<Count> from_rows(const std::vector<Row>& rows) {
  std::vector<Count> counts;
  for (const Row& row : of_study(rows, "decisions")) {
    if (row.n == 0 || std::isnan(row.ns)) continue;
    counts.push_back(
        {row.scene, row.series, 1e6 * static_cast<double>(row.missed + row.false_hits) / static_cast<double>(row.n)});
  }
  return counts;
}

std::string bars_of(const std::string& title, const std::vector<Count>& counts) {
  draw::Bars bars{
      .title = title,
      .value = {.label = "wrong decisions a million", .scale = draw::Scale::logarithmic, .low = 0.1, .high = 1e6}};
  for (const Count& count : counts) {
    if (std::find(bars.series.begin(), bars.series.end(), count.method) != bars.series.end()) continue;
    bars.series.insert(count.method.starts_with("ours") ? bars.series.begin() : bars.series.end(), count.method);
  }
  for (const Count& count : counts) {
    auto group =
        std::find_if(bars.groups.begin(), bars.groups.end(), [&](const auto& g) { return g.name == count.family; });
    if (group == bars.groups.end()) {
      bars.groups.push_back({count.family, std::vector<std::optional<double>>(bars.series.size())});
      group = bars.groups.end() - 1;
    }
    const auto at = std::find(bars.series.begin(), bars.series.end(), count.method) - bars.series.begin();
    group->values[static_cast<std::size_t>(at)] = count.per_million;
  }
  return draw::svg(bars);
}

/// One drawing a query that others answered as well, and all counts as a table.
std::string census_body(const Csv& census, std::string& table) {
  std::vector<std::string> queries;
  for (std::size_t i = 0; i < census.rows.size(); ++i) {
    const std::string query = census.text(i, "query");
    if (std::find(queries.begin(), queries.end(), query) == queries.end()) queries.push_back(query);
  }
  std::string body;
  for (const std::string& query : queries) {
    std::vector<Count> counts;
    bool compared = false;
    for (std::size_t i = 0; i < census.rows.size(); ++i) {
      const double n = census.number(i, "n");
      if (census.text(i, "query") != query || !(n > 0)) continue;
      const std::string method = census.text(i, "method");
      compared = compared || method != "collided";
      counts.push_back({census.text(i, "family"), method == "collided" ? "ours" : method,
                        1e6 * (census.number(i, "missed") + census.number(i, "false")) / n});
    }
    if (compared) body += bars_of(query, counts);
  }
  table = "<table><thead><tr>";
  for (const std::string& name : census.header) table += "<th>" + draw::escaped(name) + "</th>";
  table += "</tr></thead><tbody>\n";
  for (const auto& row : census.rows) {
    table += "<tr>";
    for (const std::string& text : row) table += "<td>" + draw::escaped(text) + "</td>";
    table += "</tr>\n";
  }
  table += "</tbody></table>\n";
  return body.empty() ? table : body;
}

}  // namespace

std::vector<Figure> decision_figures(const std::vector<Row>& rows, const Csv& census) {
  Figure own{
      "decisions", "Wrong decisions per million: rays inside a closed mesh",
      "Rays from the centre of a closed icosphere (20,480 triangles, 1,280 in the quick form; coordinates in float): "
      "every ray hits, so each miss is wrong.",
      ""};
  const std::vector<Count> counts = from_rows(rows);
  if (!counts.empty()) {
    own.body = bars_of(own.title, counts);
    own.rows = rows_table(of_study(rows, "decisions"));
    own.caption += " n = " + std::to_string(of_study(rows, "decisions").front().n) +
                   " a family and method; 0 of n means less "
                   "than 3/n with 95 % confidence.";
  }
  Figure counted{
      "census", "Wrong decisions per million: the census",
      "Missed and false together, family by family, each decision against exact integer or rational truth; n of every "
      "row is in its table, and 0 of n means less than 3/n with 95 % confidence. Rows of the program census.",
      ""};
  if (!census.rows.empty()) counted.body = census_body(census, counted.rows);
  return {own, counted};
}

std::vector<Figure> pair_figures(const std::vector<PinnedCell>& pairs) {
  Figure figure{
      "pairs", "Worst error of every pair and query",
      "The worst error seen, relative to the truth (to a millimetre, or a step, where the truth is less), against "
      "rational or 100-digit truth; error / bound is at most 1 or the build fails. A third each: random shapes, "
      "needles of aspect 1e6, a lattice 1,000 km out. Pinned by the test report_pairs.",
      ""};
  if (pairs.empty()) return {figure};
  std::string html =
      "<table><thead><tr><th class=\"t\">query</th><th class=\"t\">pair</th><th>answers</th><th>wrong</th>"
      "<th>worst error</th><th>error / bound, worst</th><th>bound, median</th></tr></thead><tbody>\n";
  for (const PinnedCell& pin : pairs) {
    const PairCell& cell = pin.cell;
    html += "<tr><td class=\"t\">" + cell.query + "</td><td class=\"t\">" + cell.pair + "</td>";
    if (cell.n == 0) {
      html += "<td colspan=\"5\">no data</td></tr>\n";
      continue;
    }
    for (const std::string& text : {std::to_string(cell.n), std::to_string(cell.wrong), short_number(cell.worst_error),
                                    short_number(cell.worst_ratio), short_number(cell.median_width)}) {
      html += "<td>" + text + "</td>";
    }
    html += "</tr>\n";
  }
  figure.body = html + "</tbody></table>\n";
  return {figure};
}

}  // namespace collided::report
