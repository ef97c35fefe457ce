#pragma once

#include "tests/studies/report/measured/pairs.hpp"
#include "tests/studies/report/page/page.hpp"

namespace collided::report {

/// All that the page is made of. Tables of other programs are empty where they were not given.
struct Tables {
  std::vector<Row> rows;
  std::vector<PinnedCell> pairs{};
  Csv census{};    // columns query, family, method, n, missed, false, uncertain, exact, ns
  Csv response{};  // columns scene, method, stiffness, step, ...: see the response study
  Csv contact{};   // columns integrator, stiffness, step, ...: see the study of one contact
  Csv mutants{};   // columns room, file, line, bug, outcome, by: see tests/mutants
};

/// The figures of the page, in its order. One without data stays, and says so.
std::vector<Figure> figures(const Tables& tables);

std::vector<Figure> work_precision_figures(const std::vector<Row>& rows);
std::vector<Figure> level_figures(const std::vector<Row>& rows);
std::vector<Figure> response_figures(const Csv& response);
std::vector<Figure> contact_figures(const Csv& contact);
std::vector<Figure> map_figures(const std::vector<Row>& rows);
std::vector<Figure> decision_figures(const std::vector<Row>& rows, const Csv& census);
std::vector<Figure> index_figures(const std::vector<Row>& rows);
std::vector<Figure> growth_figures(const std::vector<Row>& rows);
std::vector<Figure> arrival_figures(const std::vector<Row>& rows);
std::vector<Figure> stage_figures(const std::vector<Row>& rows);
std::vector<Figure> pair_figures(const std::vector<PinnedCell>& pairs);
Figure mutant_figure(const Csv& mutants);

/// Rows of one study, in order.
std::vector<Row> of_study(const std::vector<Row>& rows, const std::string& study);

}  // namespace collided::report
