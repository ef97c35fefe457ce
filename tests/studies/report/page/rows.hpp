#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace collided::report {

/// Where and how rows came to be; every row of a file carries it.
struct Provenance {
  std::string machine;
  std::string commit;
  std::string command;
  unsigned long long seed = 0;
  bool quick = false;
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One method on one set of questions. NaN: not measured, or has no meaning here.
struct Row {
  std::string study{};  // the figure it belongs to
  std::string scene{};
  std::string series{};  // the line of the figure
  std::string label{};   // the point on the line
  double knob = kUnknown;
  double error_max = kUnknown;  // relative, of the answers whose decision is right
  double error_p50 = kUnknown;
  double bound_ratio = kUnknown;  // largest error / bound
  double bound_max = kUnknown;    // largest bound, relative like the errors
  double ns = kUnknown;           // a question: median of the repeats, and their range
  double ns_low = kUnknown;
  double ns_high = kUnknown;
  long n = 0;
  long missed = 0;
  long false_hits = 0;
  long undecided = 0;
  std::string note{};
  double nodes = kUnknown;       // of an index that a question visits
  double tests = kUnknown;       // exact tests of a question
  double references = kUnknown;  // of an index, a triangle
  double bytes = kUnknown;       // of an index, a triangle
  double build_ms = kUnknown;    // of an index
};

void write_rows(const std::filesystem::path& file, const std::vector<Row>& rows, const Provenance& from);

/// A table of text with a header line; commas inside quotes are kept. Empty if the file is not there.
struct Csv {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  /// -1: no such column.
  int column(const std::string& name) const;
  double number(std::size_t row, const std::string& name) const;
  std::string text(std::size_t row, const std::string& name) const;
};
Csv read_csv(const std::filesystem::path& file);

/// A number in as few digits as the given ones, "1.2e-16"; "-" for NaN.
std::string short_number(double value, int digits = 2);

}  // namespace collided::report
