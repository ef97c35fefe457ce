#include "tests/studies/report/page/readme.hpp"

#include <fstream>
#include <stdexcept>

#include "tests/studies/report/measured/pairs.hpp"
#include "tests/studies/report/page/rows.hpp"

namespace collided::report {
namespace {

constexpr const char* kShown[][2] = {{"ray", "ray, closest hit in a mesh"},
                                     {"ray_hard", "rays at vertices, edges, along faces"},
                                     {"sphere_overlap", "sphere-triangle depth"},
                                     {"box_overlap", "box-triangle depth"},
                                     {"pair_depth", "box-box depth"},
                                     {"nearest", "nearest distance in a mesh"},
                                     {"time", "time of contact"}};

bool is_shown(const std::string& series, const std::string& label) {
  if (series == "ours: error asked" || label == "bounded double" || label == "rationals always") return false;
  return series != "ours: width asked" || label == "width 0";
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

namespace {

/// "4.6e-7, 13 wrong, 520 ns"
std::string price(const Csv& csv, std::size_t row) {
  std::string text = csv.text(row, "worst_error");
  if (csv.number(row, "wrong") > 0) text += ", **" + csv.text(row, "wrong") + " wrong**";
  return text + ", " + csv.text(row, "ns") + " ns";
}

/// One line a query: what plain arithmetic, ours and the peers made of the same questions.
std::string price_line(const Csv& csv, const std::string& study, const std::string& name) {
  std::string plain_float = "no data";
  std::string plain_double = "no data";
  std::string ours = "no data";
  std::string peers;
  std::string n = "0";
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    if (csv.text(i, "study") != study) continue;
    const std::string method = csv.text(i, "method");
    n = csv.text(i, "n");
    if (method == "ours: uncertified, float") {
      plain_float = price(csv, i);
    } else if (method == "ours: uncertified, double") {
      plain_double = price(csv, i);
    } else if (method.starts_with("ours")) {
      ours = price(csv, i);
    } else {
      peers += (peers.empty() ? "" : "; ") + method + ": " + price(csv, i);
    }
  }
  return "| " + name + " | " + ours + " | " + plain_double + " | " + plain_float + " | " +
         (peers.empty() ? "-" : peers) + " | " + n + " |\n";
}

}  // namespace

std::string readme_part(const std::filesystem::path& pairs, const std::filesystem::path& prices) {
  std::ifstream first(prices);
  std::string from;
  std::getline(first, from);
  if (!from.starts_with("# ")) throw std::runtime_error(prices.string() + ": its first line must say where it is from");
  std::string text =
      "Worst relative error (of times: in steps), wrong yes-or-no answers of n, and processor time of one question. "
      "Times are "
      "of this run: " +
      from.substr(2) + ".\n\n";
  text += "| query | ours, exact on doubt | plain double | plain float | peers | n |\n|---|---|---|---|---|--:|\n";
  const Csv csv = read_csv(prices);
  for (const auto& [study, name] : kShown) text += price_line(csv, study, name);
  text +=
      "\n<details><summary>Worst error of every pair and query, each with the ceiling that a test holds it "
      "to</summary>\n\n"
      "Relative to the truth (rational or 100 digits), or to a millimetre or a step where the truth is less. A third "
      "each: random "
      "shapes, needles, a lattice 1,000 km out. error / bound is at most 1, always.\n\n"
      "| query | pair | answers | wrong | worst error | ceiling | error / bound, worst "
      "|\n|---|---|--:|--:|--:|--:|--:|\n";
  std::string last;
  for (const PinnedCell& pin : read_pinned(pairs)) {
    const PairCell& cell = pin.cell;
    text += "| " + (cell.query == last ? "" : cell.query) + " | " + cell.pair + " | " + std::to_string(cell.n) + " | " +
            std::to_string(cell.wrong) + " | " + number(cell.worst_error) + " | " + number(pin.ceiling, 1) + " | " +
            number(cell.worst_ratio) + " |\n";
    last = cell.query;
  }
  return text + "\n</details>\n";
}

}  // namespace collided::report
