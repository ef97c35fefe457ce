#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/accuracy/census/subjects.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::census {
using namespace engine;
namespace {

constexpr double kShortPart = 0.005;

/// The product is never wrong, and on generic scenes seldom needs more than its filter.
int failures(const Table& table) {
  int failed = 0;
  std::uint64_t generic = 0, uncertain = 0, exact = 0;
  for (const Row& row : table.rows()) {
    if (row.method != kOurs) continue;
    if (row.wrong() > 0) {
      ++failed;
      std::printf("WRONG: %s %s, %llu of %llu\n", row.query.c_str(), row.family.c_str(),
                  static_cast<unsigned long long>(row.wrong()), static_cast<unsigned long long>(row.count));
    }
    if (row.family != name(Family::random)) continue;
    generic += row.count;
    uncertain += row.uncertain;
    exact += row.exact;
    if (row.uncertain * 1000 > row.count) ++failed, std::printf("UNCERTAIN too often: %s\n", row.query.c_str());
  }
  std::printf("generic scenes: %llu questions, double uncertain in %llu, exact arithmetic in %llu\n",
              static_cast<unsigned long long>(generic), static_cast<unsigned long long>(uncertain),
              static_cast<unsigned long long>(exact));
  // One in a million, and room for the one that a short census may meet.
  if (exact > 1 + generic / 1'000'000) ++failed, std::printf("EXACT too often\n");
  return failed;
}

int run(int argc, char** argv) {
  std::mt19937_64 generator = oracle::seeded(20261121);
  Effort effort{generator, kShortPart, 20'000, ""};
  std::string csv;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (std::strcmp(argv[i], "--long") == 0) effort.part = 1, effort.peer_count = 1'000'000;
    else if (std::strcmp(argv[i], "--part") == 0 && more) effort.part = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "--only") == 0 && more) effort.only = argv[++i];
    else if (std::strcmp(argv[i], "--csv") == 0 && more) csv = argv[++i];
    else return std::fprintf(stderr, "usage: census [--long | --part P] [--only QUERY] [--csv FILE]\n"), 2;
  }
  Table table;
  count_rays(table, effort);
  count_pairs(table, effort);
  if (!csv.empty() && !table.write(csv)) return std::fprintf(stderr, "cannot write %s\n", csv.c_str()), 2;
  return failures(table) == 0 ? 0 : 1;
}

}  // namespace
}  // namespace collided::census

/// How often each exact decision is wrong, against whole-number truth: 0 exit when never, 1 when ever.
int main(int argc, char** argv) { return collided::census::run(argc, argv); }
