#pragma once

#include <string>
#include <vector>

#include "tests/studies/report/page/rows.hpp"

namespace collided::report {

/// One numbered figure or table of the page.
struct Figure {
  std::string id;  // of the anchor
  std::string title;
  std::string caption;  // what is plotted, on what, how
  std::string body;     // SVG or a table; empty: nothing was measured, and the page says so
  std::string rows{};   // the numbers behind a drawing, folded away
};

/// What stands above the figures.
struct Heading {
  std::string title;
  std::string introduction;  // HTML
  std::string rows_file;     // beside the page
};
Heading report_heading();

/// The page, self-contained: contents, figures in order, where everything comes from.
std::string page(const std::vector<Figure>& figures, const Provenance& from, const std::string& date,
                 const Heading& heading = report_heading());

/// A table of rows as HTML; columns without any number are left out.
std::string rows_table(const std::vector<Row>& rows);

}  // namespace collided::report
