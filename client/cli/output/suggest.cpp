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

/// Shorter texts are contained in too many names to be of use.
constexpr std::size_t kLeastPart = 3;

}  // namespace

std::vector<std::string> nearest_names(std::string_view wrong, const std::vector<std::string>& names,
                                       std::size_t most) {
  const std::size_t limit = std::max<std::size_t>(1, wrong.size() / 3);
  const std::string bare_wrong = bare(wrong);
  std::vector<std::pair<std::size_t, std::string>> found;
  for (const std::string& name : names) {
    const std::size_t longer = std::max(name.size(), wrong.size());
    const std::size_t shorter = std::min(name.size(), wrong.size());
    const std::size_t cut = name.rfind('/');
    const std::string_view last =
        cut == std::string::npos ? std::string_view() : std::string_view(name).substr(cut + 1);
    if (bare(name) == bare_wrong) {
      found.emplace_back(0, name);
    } else if (longer - shorter <= limit + 2 && edit_distance(wrong, name) <= limit) {
      found.emplace_back(edit_distance(wrong, name), name);
    } else if (!last.empty() && edit_distance(wrong, last) <= limit) {
      found.emplace_back(limit + 1 + edit_distance(wrong, last), name);
    } else if (wrong.size() >= kLeastPart && name.find(wrong) != std::string::npos) {
      found.emplace_back(3 * limit, name);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> nearest;
  for (std::size_t at = 0; at < std::min(most, found.size()); ++at) nearest.push_back(found[at].second);
  return nearest;
}

std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names) {
  const std::vector<std::string> nearest = nearest_names(wrong, names, 1);
  return nearest.empty() ? std::string() : fmt::format("; did you mean '{}'?", nearest.front());
}

}  // namespace collided::cli
