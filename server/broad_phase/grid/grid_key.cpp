#include "server/broad_phase/grid/grid_key.hpp"

#include <algorithm>
#include <bit>

namespace collided::engine::grid {

void Axis::set(Cell first, Cell last) {
  first_ = first;
  last_ = last;
  drop_ = 0;
  distinct_.clear();
  ranks_.clear();
}

void Axis::set(std::vector<Cell> cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  drop_ = 0;
  distinct_ = std::move(cells);
  ranks_.clear();
  std::uint64_t rank = 0;
  for (std::size_t i = 0; i < distinct_.size(); ++i) {
    if (i > 0) rank += distinct_[i] - distinct_[i - 1] == 1 ? 1 : 2;
    ranks_.push_back(rank);
  }
}

int Axis::bits() const {
  const std::uint64_t span = distinct_.empty() ? static_cast<std::uint64_t>(last_ - first_) : ranks_.back() >> drop_;
  return static_cast<int>(std::bit_width(span + 2));
}

std::uint64_t Axis::ranked_at_least(Cell cell) const {
  const auto found = std::lower_bound(distinct_.begin(), distinct_.end(), cell);
  if (found == distinct_.end()) return (ranks_.back() >> drop_) + 2;
  return (ranks_[static_cast<std::size_t>(found - distinct_.begin())] >> drop_) + 1;
}

std::uint64_t Axis::ranked_at_most(Cell cell) const {
  const auto after = std::upper_bound(distinct_.begin(), distinct_.end(), cell);
  if (after == distinct_.begin()) return 0;
  return (ranks_[static_cast<std::size_t>(after - distinct_.begin()) - 1] >> drop_) + 1;
}

std::size_t Axis::bytes() const {
  return distinct_.capacity() * sizeof(distinct_[0]) + ranks_.capacity() * sizeof(ranks_[0]);
}

}  // namespace collided::engine::grid
