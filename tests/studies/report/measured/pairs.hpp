#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace collided::report {

/// What was seen of one query about one pair of shapes.
struct PairCell {
  std::string query;
  std::string pair;
  long n = 0;               // answers whose number was compared
  double worst_error = 0;   // relative to the truth, or to a millimetre (a step, for times) where that is more
  double worst_ratio = 0;   // error / bound: at most 1
  double median_width = 0;  // bound, relative in the same way: what a caller can rely on
  long wrong = 0;           // decisions
};

/// Every pair and query, n questions of each of three families (random, needles, a lattice a thousand kilometres out).
std::vector<PairCell> pair_cells(unsigned long long seed, int questions);

/// The committed form: a ceiling of one significant digit beside each cell.
struct PinnedCell {
  PairCell cell;
  double ceiling = 0;
};
std::vector<PinnedCell> pinned(const std::vector<PairCell>& cells);
void write_pinned(const std::filesystem::path& file, const std::vector<PinnedCell>& cells, unsigned long long seed,
                  int questions);
std::vector<PinnedCell> read_pinned(const std::filesystem::path& file);

/// One line a complaint: a cell above its ceiling, a ceiling more than ten times too loose, an error beyond its bound,
/// a wrong decision, a cell without a pin or without answers.
std::vector<std::string> complaints(const std::vector<PairCell>& cells, const std::vector<PinnedCell>& pins);

}  // namespace collided::report
