#include "tests/report/readme.hpp"

#include <array>
#include <fstream>
#include <stdexcept>

#include "tests/report/pairs.hpp"
#include "tests/report/rows.hpp"

namespace collided::report {
namespace {

constexpr const char* kShown[][2] = {
    {"ray", "ray, closest hit"}, {"ray_hard", "ray at edges, vertices, along faces"}, {"sphere_overlap", "sphere-triangle depth"},
    {"box_overlap", "box-triangle depth"}, {"pair_depth", "box-box depth"}, {"nearest", "nearest distance in a mesh"},
    {"time", "time of contact"}};

bool is_shown(const std::string& series, const std::string& label) {
  if (series == "ours: error asked") return false;
  return series != "ours: width asked" || label == "width 0" || label == "width 1e-4";
}

std::string number(double value, int digits = 2) { return short_number(value, digits); }

}  // namespace

void write_prices(const std::filesystem::path& rows, const std::filesystem::path& prices) {
  const Csv csv = read_csv(rows);
  if (csv.rows.empty()) throw std::runtime_error(rows.string() + ": no rows");
  std::ofstream out(prices);
  out << "# " << csv.text(0, "machine") << " | " << csv.text(0, "commit") << " | seed " << csv.text(0, "seed") << " | "
      << csv.text(0, "command") << "\nstudy,method,worst_error,wrong,undecided,n,ns\n";
  for (const auto& [study, name] : kShown) {
    for (std::size_t i = 0; i < csv.rows.size(); ++i) {
      if (csv.text(i, "study") != study || !is_shown(csv.text(i, "series"), csv.text(i, "label"))) continue;
      out << study << ',' << '"' << csv.text(i, "series") << ", " << csv.text(i, "label") << '"' << ','
          << number(csv.number(i, "error_max")) << ',' << csv.number(i, "missed") + csv.number(i, "false") << ','
          << csv.text(i, "undecided") << ',' << csv.text(i, "n") << ',' << number(csv.number(i, "ns"), 2) << '\n';
    }
  }
}

std::string readme_part(const std::filesystem::path& pairs, const std::filesystem::path& prices) {
  std::ifstream first(prices);
  std::string from;
  std::getline(first, from);
  if (!from.starts_with("# ")) throw std::runtime_error(prices.string() + ": its first line must say where it is from");
  std::string text = "What precision costs (`deploy/report` draws it; times are of " + from.substr(2) + "):\n\n";
  text += "| query | method | worst relative error | wrong | undecided | of | ns |\n|---|---|--:|--:|--:|--:|--:|\n";
  const Csv csv = read_csv(prices);
  for (const auto& [study, name] : kShown) {
    bool begun = false;
    for (std::size_t i = 0; i < csv.rows.size(); ++i) {
      if (csv.text(i, "study") != study) continue;
      text += std::string("| ") + (begun ? "" : name) + " | " + csv.text(i, "method") + " | " + csv.text(i, "worst_error") +
              " | " + csv.text(i, "wrong") + " | " + csv.text(i, "undecided") + " | " + csv.text(i, "n") + " | " +
              csv.text(i, "ns") + " |\n";
      begun = true;
    }
  }
  text += "\nThe worst relative error seen for each query and pair, against rational or 100-digit truth (random shapes, needles, "
          "and a lattice 1,000 km out); a test fails above the ceiling. An error is never more than its bound:\n\n"
          "| query | pair | answers | wrong | worst error | ceiling | error / bound, worst |\n|---|---|--:|--:|--:|--:|--:|\n";
  std::string last;
  for (const PinnedCell& pin : read_pinned(pairs)) {
    const PairCell& cell = pin.cell;
    text += "| " + (cell.query == last ? "" : cell.query) + " | " + cell.pair + " | " + std::to_string(cell.n) + " | " +
            std::to_string(cell.wrong) + " | " + number(cell.worst_error) + " | " + number(pin.ceiling, 1) + " | " +
            number(cell.worst_ratio) + " |\n";
    last = cell.query;
  }
  return text;
}

}  // namespace collided::report
