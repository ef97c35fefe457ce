#include <map>

#include <fmt/core.h>

#include "client/draw/svg.hpp"
#include "tests/studies/report/figures/figures.hpp"

namespace collided::report {
namespace {

struct Score {
  int killed = 0;
  int harmless = 0;
  int survived = 0;

  void count(const std::string& outcome) {
    ++(outcome == "killed" ? killed : outcome == "harmless" ? harmless : survived);
  }
  std::string cells() const {
    const int judged = killed + survived;
    return fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", judged + harmless, killed, harmless,
                       survived, judged == 0 ? "" : fmt::format("{:.1f} %", 100.0 * killed / judged));
  }
};

std::string score_table(const Csv& mutants) {
  std::map<std::string, Score> by_room;
  Score all;
  for (std::size_t i = 0; i < mutants.rows.size(); ++i) {
    by_room[mutants.text(i, "room")].count(mutants.text(i, "outcome"));
    all.count(mutants.text(i, "outcome"));
  }
  std::string html =
      "<table><thead><tr><th class=\"t\">room</th><th>bugs</th><th>killed</th><th>harmless</th><th>survived</th>"
      "<th>killed of those that can be</th></tr></thead><tbody>\n";
  for (const auto& [room, score] : by_room)
    html += "<tr><td class=\"t\">" + draw::escaped(room) + "</td>" + score.cells() + "</tr>\n";
  return html + "<tr><td class=\"t\">all</td>" + all.cells() + "</tr>\n</tbody></table>\n";
}

std::string bug_table(const Csv& mutants) {
  std::string html =
      "<table><thead><tr><th class=\"t\">place</th><th class=\"t\">bug</th><th class=\"t\">outcome</th>"
      "<th class=\"t\">by</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < mutants.rows.size(); ++i) {
    html += "<tr>";
    for (const std::string& text : {mutants.text(i, "file") + ":" + mutants.text(i, "line"), mutants.text(i, "bug"),
                                    mutants.text(i, "outcome"), mutants.text(i, "by")}) {
      html += "<td class=\"t\">" + draw::escaped(text) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

}  // namespace

Figure mutant_figure(const Csv& mutants) {
  Figure figure{
      "mutants", "Planted bugs that the tests notice",
      "Single bugs planted by rule and seed all over the product, each run against the default tests that reach its "
      "line. Harmless: nobody can notice, with the reason. Rows of the program tests/mutants/mutants.py.",
      ""};
  if (!mutants.rows.empty()) {
    figure.body = score_table(mutants);
    figure.rows = bug_table(mutants);
  }
  return figure;
}

}  // namespace collided::report
