#pragma once

#include "tests/report/page.hpp"

namespace collided::report {

/// The figures of the page, in its order, from the rows of the studies and the tables of other programs (a file name
/// may be empty, or lead nowhere: the figure then says that there is no data).
std::vector<Figure> figures(const std::vector<Row>& rows, const std::string& census_csv,
                            const std::string& response_csv);

/// Rows of one study, in order.
std::vector<Row> of_study(const std::vector<Row>& rows, const std::string& study);

}  // namespace collided::report
