#include "tests/studies/report/measured/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/studies/report/page/rows.hpp"

namespace collided::report {
namespace {

/// Up to one significant digit, as a text reads it back.
double rounded_up(double value) {
  if (value == 0) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double digit = std::ceil(value / power * (1 - 1e-9));
  return std::stod(short_number(digit * power, 1));
}

}  // namespace

std::vector<PinnedCell> pinned(const std::vector<PairCell>& cells) {
  std::vector<PinnedCell> result;
  for (const PairCell& cell : cells) result.push_back({cell, rounded_up(cell.worst_error)});
  return result;
}

void write_pinned(const std::filesystem::path& file, const std::vector<PinnedCell>& cells, unsigned long long seed,
                  int questions) {
  std::ofstream out(file);
  out << "# report_tables pairs FILE, seed " << seed << ", " << questions << " questions a family\n"
      << "query,pair,n,wrong,worst_error,error_over_bound,median_width,ceiling\n";
  for (const auto& [cell, ceiling] : cells) {
    out << cell.query << ',' << cell.pair << ',' << cell.n << ',' << cell.wrong << ',' << short_number(cell.worst_error)
        << ',' << short_number(cell.worst_ratio) << ',' << short_number(cell.median_width) << ','
        << short_number(ceiling, 1) << '\n';
  }
}

std::vector<PinnedCell> read_pinned(const std::filesystem::path& file) {
  const Csv csv = read_csv(file);
  std::vector<PinnedCell> cells;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    cells.push_back({{.query = csv.text(i, "query"),
                      .pair = csv.text(i, "pair"),
                      .n = static_cast<long>(csv.number(i, "n")),
                      .worst_error = csv.number(i, "worst_error"),
                      .worst_ratio = csv.number(i, "error_over_bound"),
                      .median_width = csv.number(i, "median_width"),
                      .wrong = static_cast<long>(csv.number(i, "wrong"))},
                     csv.number(i, "ceiling")});
  }
  return cells;
}

std::vector<std::string> complaints(const std::vector<PairCell>& cells, const std::vector<PinnedCell>& pins) {
  std::vector<std::string> result;
  for (const PairCell& cell : cells) {
    const std::string name = cell.query + ", " + cell.pair + ": ";
    if (cell.n == 0) result.push_back(name + "no answers to compare");
    if (cell.wrong != 0) result.push_back(name + std::to_string(cell.wrong) + " wrong decisions");
    if (!(cell.worst_ratio <= 1))
      result.push_back(name + "error " + short_number(cell.worst_ratio) + " times its bound");
    const auto pin = std::find_if(pins.begin(), pins.end(), [&](const PinnedCell& p) {
      return p.cell.query == cell.query && p.cell.pair == cell.pair;
    });
    if (pin == pins.end()) {
      result.push_back(name + "no ceiling");
    } else if (!(cell.worst_error <= pin->ceiling)) {
      result.push_back(name + "worst error " + short_number(cell.worst_error) + ", ceiling " +
                       short_number(pin->ceiling, 1));
    } else if (pin->ceiling > 10 * cell.worst_error) {
      result.push_back(name + "ceiling " + short_number(pin->ceiling, 1) + " is too loose for " +
                       short_number(cell.worst_error));
    }
  }
  if (pins.size() != cells.size()) result.push_back("another number of cells than ceilings");
  return result;
}

}  // namespace collided::report
