#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace collided::engine {

/// Sets of the numbers 0 to count - 1, at first one number each, that can only be joined. The smallest number of a set
/// is its name.
///
/// cost      nearly constant for each call
/// threads   one at a time
/// source    Galler, Fischer, "An improved equivalence algorithm", 1964; halving paths: van Leeuwen, van der Weide,
///           1977
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

  /// The name of the number's set.
  std::uint32_t find(std::uint32_t number) {
    while (parents_[number] != number) {
      parents_[number] = parents_[parents_[number]];
      number = parents_[number];
    }
    return number;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t first = find(a);
    const std::uint32_t second = find(b);
    parents_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace collided::engine
