// The tables that are pinned and shown in the guide to accuracy.
//   report_tables pairs FILE             measures every shape pair and query and writes FILE with new ceilings
//   report_tables check FILE             measures again; fails on a cell above its ceiling, or on a loose ceiling
//   report_tables prices ROWS FILE       keeps of a report's rows.csv what the guide shows
//   report_tables readme PAIRS PRICES    prints the guide's part
//   report_tables page DIR               fails if the page written there is broken or empty, or a bound does not hold
#include <cstdio>
#include <exception>

#include "tests/studies/report/measured/pairs.hpp"
#include "tests/studies/report/page/page_check.hpp"
#include "tests/studies/report/page/readme.hpp"

namespace {

using namespace collided::report;

constexpr unsigned long long kSeed = 2025;
constexpr int kQuestions = 48;

int print(const std::vector<std::string>& complaints) {
  for (const std::string& line : complaints) std::printf("%s\n", line.c_str());
  std::printf("%zu complaints\n", complaints.size());
  return complaints.empty() ? 0 : 1;
}

int check(const char* file) {
  std::printf("seed %llu, %d questions a family\n", kSeed, kQuestions);
  return print(complaints(pair_cells(kSeed, kQuestions), read_pinned(file)));
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 2 ? argv[1] : "";
  if (verb == "pairs") {
    write_pinned(argv[2], pinned(pair_cells(kSeed, kQuestions)), kSeed, kQuestions);
    return 0;
  }
  if (verb == "check") return check(argv[2]);
  if (verb == "page") return print(page_complaints(argv[2]));
  if (verb == "prices" && argc == 4) {
    write_prices(argv[2], argv[3]);
    return 0;
  }
  if (verb == "readme" && argc == 4) {
    std::fputs(readme_part(argv[2], argv[3]).c_str(), stdout);
    return 0;
  }
  std::fputs("usage: report_tables pairs FILE | check FILE | prices ROWS FILE | readme PAIRS PRICES | page DIR\n",
             stderr);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 2;
}
