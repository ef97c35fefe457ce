#include "client/cli/output/suggest.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace collided::cli {
namespace {

constexpr std::size_t kLongestCompared = 64;

/// Edit distance by optimal string alignment: insertions, deletions, replacements, swaps of neighbours.
/// source  Boytsov, "Indexing methods for approximate dictionary searching", 2011
std::size_t edit_distance(std::string_view a, std::string_view b) {
  a = a.substr(0, kLongestCompared);
  b = b.substr(0, kLongestCompared);
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

/// A name without separators: "pallet_07" and "pallet7" give the same text.
std::string bare(std::string_view name) {
  std::string text;
  for (std::size_t at = 0; at < name.size(); ++at) {
    const char c = name[at];
    if (c == '_' || c == '-' || c == '/' || c == ' ' || c == '.') continue;
    const bool after_digit = at > 0 && name[at - 1] >= '0' && name[at - 1] <= '9';
    const bool before_digit = at + 1 < name.size() && name[at + 1] >= '0' && name[at + 1] <= '9';
    if (c == '0' && !after_digit && before_digit) continue;
    text += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  return text;
}

/// Shorter texts occur in too many names to be useful.
constexpr std::size_t kLeastPart = 3;

}  // namespace

std::vector<std::string> nearest_names(std::string_view wrong, const std::vector<std::string>& names,
                                       std::size_t most) {
  const std::size_t limit = std::max<std::size_t>(1, wrong.size() / 3);
  const std::string bare_wrong = bare(wrong);
  struct Near {
    std::size_t edits = 0;
    std::size_t differs_at = 0;  // the first differing letter; of two equally near names the later one was meant
    std::string name;
  };
  std::vector<Near> found;
  const auto add = [&](std::size_t edits, const std::string& name) {
    const auto same = std::mismatch(wrong.begin(), wrong.end(), name.begin(), name.end()).first - wrong.begin();
    found.push_back({edits, static_cast<std::size_t>(same), name});
  };
  for (const std::string& name : names) {
    const std::size_t longer = std::max(name.size(), wrong.size());
    const std::size_t shorter = std::min(name.size(), wrong.size());
    const std::size_t cut = name.rfind('/');
    const std::string_view last =
        cut == std::string::npos ? std::string_view() : std::string_view(name).substr(cut + 1);
    if (bare(name) == bare_wrong) {
      add(0, name);
    } else if (longer - shorter <= limit + 2 && edit_distance(wrong, name) <= limit) {
      add(edit_distance(wrong, name), name);
    } else if (!last.empty() && edit_distance(wrong, last) <= limit) {
      add(limit + 1 + edit_distance(wrong, last), name);
    } else if (wrong.size() >= kLeastPart && name.find(wrong) != std::string::npos) {
      add(3 * limit, name);
    }
  }
  std::sort(found.begin(), found.end(), [](const Near& a, const Near& b) {
    if (a.edits != b.edits) return a.edits < b.edits;
    return a.differs_at != b.differs_at ? a.differs_at > b.differs_at : a.name < b.name;
  });
  std::vector<std::string> nearest;
  for (std::size_t at = 0; at < std::min(most, found.size()); ++at) nearest.push_back(found[at].name);
  return nearest;
}

std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names) {
  const std::vector<std::string> nearest = nearest_names(wrong, names, 1);
  return nearest.empty() ? std::string() : fmt::format("; did you mean '{}'?", nearest.front());
}

}  // namespace collided::cli
