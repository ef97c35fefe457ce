#include "tests/studies/report/page/rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace collided::report {
namespace {

std::string in_quotes(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string full_number(double value) {
  if (std::isnan(value)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (inside && i + 1 < line.size() && line[i + 1] == '"') {
        result.back() += line[++i];
      } else {
        inside = !inside;
      }
    } else if (line[i] == ',' && !inside) {
      result.emplace_back();
    } else if (line[i] != '\r') {
      result.back() += line[i];
    }
  }
  return result;
}

}  // namespace

void write_rows(const std::filesystem::path& file, const std::vector<Row>& rows, const Provenance& from) {
  std::ofstream out(file);
  out << "study,scene,series,label,knob,error_max,error_p50,bound_ratio,bound_max,ns,ns_low,ns_high,n,missed,false,"
         "undecided,note,"
         "nodes,tests,references,bytes,build_ms,"
         "machine,commit,seed,command\n";
  for (const Row& r : rows) {
    for (const std::string* text : {&r.study, &r.scene, &r.series, &r.label}) out << in_quotes(*text) << ',';
    for (const double value :
         {r.knob, r.error_max, r.error_p50, r.bound_ratio, r.bound_max, r.ns, r.ns_low, r.ns_high}) {
      out << full_number(value) << ',';
    }
    out << r.n << ',' << r.missed << ',' << r.false_hits << ',' << r.undecided << ',' << in_quotes(r.note) << ',';
    for (const double value : {r.nodes, r.tests, r.references, r.bytes, r.build_ms}) out << full_number(value) << ',';
    out << in_quotes(from.machine) << ',' << in_quotes(from.commit) << ',' << from.seed << ','
        << in_quotes(from.command) << '\n';
  }
}

int Csv::column(const std::string& name) const {
  const auto found = std::find(header.begin(), header.end(), name);
  return found == header.end() ? -1 : static_cast<int>(found - header.begin());
}

std::string Csv::text(std::size_t row, const std::string& name) const {
  const int at = column(name);
  return at < 0 || static_cast<std::size_t>(at) >= rows[row].size() ? "" : rows[row][at];
}

double Csv::number(std::size_t row, const std::string& name) const {
  const std::string value = text(row, name);
  char* end = nullptr;
  const double result = std::strtod(value.c_str(), &end);
  return end == value.c_str() ? kUnknown : result;
}

Csv read_csv(const std::filesystem::path& file) {
  Csv csv;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (csv.header.empty()) {
      csv.header = fields(line);
    } else {
      csv.rows.push_back(fields(line));
    }
  }
  return csv;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (value == 0) return "0";
  if (std::isinf(value)) return value > 0 ? "infinite" : "-infinite";
  char text[40];
  const double size = std::abs(value);
  if (size >= 1e-2 && size < 1e5) {
    std::snprintf(text, sizeof text, "%.*g",
                  size >= 1 ? std::max(digits, static_cast<int>(std::log10(size)) + 1) : digits, value);
    return text;
  }
  std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  // "1.2e-07" as "1.2e-7", "1.0e-07" as "1e-7".
  std::string result = text;
  const std::size_t e = result.find('e');
  const int power = std::atoi(result.c_str() + e + 1);
  const bool whole = e >= 2 && result.compare(e - 2, 2, ".0") == 0;
  return result.substr(0, whole ? e - 2 : e) + "e" + std::to_string(power);
}

}  // namespace collided::report
