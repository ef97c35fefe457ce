#include "server/service/questions/nearest_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

/// Fewest edits from one word to the other, two neighbours swapped counting as one; by dynamic programming over
/// prefixes.
std::size_t edits(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return cost[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return at(a.size(), b.size());
}

}  // namespace

std::string nearest_word(std::string_view typed, std::span<const std::string> words) {
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(1, typed.size() / 3) + 1;
  for (const std::string& word : words) {
    const std::size_t cost = edits(typed, word);
    if (cost < fewest) {
      fewest = cost;
      nearest = word;
    }
  }
  return nearest;
}

std::vector<std::string> nearest_words(std::string_view typed, std::span<const std::string_view> words,
                                       std::size_t most) {
  // The difference of the lengths is a lower bound on the edits, and quick.
  const std::size_t farthest = std::max<std::size_t>(2, typed.size() / 2);
  std::vector<std::pair<std::size_t, std::string_view>> near;
  for (const std::string_view word : words) {
    const std::size_t difference = word.size() > typed.size() ? word.size() - typed.size() : typed.size() - word.size();
    if (difference > farthest) continue;
    const std::size_t cost = edits(typed, word);
    if (cost <= farthest) near.emplace_back(cost, word);
  }
  const std::size_t kept = std::min(most, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept), near.end());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kept; ++i) names.emplace_back(near[i].second);
  return names;
}

std::string did_you_mean(std::string_view typed, std::span<const std::string> words) {
  const std::string nearest = nearest_word(typed, words);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

std::string unknown_object(std::string_view name, std::span<const std::string_view> others) {
  std::string sentence = fmt::format("object {} is not in the world ({} objects)", printable(name), others.size());
  const std::vector<std::string> near = nearest_words(name, others, 3);
  if (!near.empty()) sentence += fmt::format("; nearest names: {}", fmt::join(near, ", "));
  return sentence;
}

}  // namespace collided::engine::service
