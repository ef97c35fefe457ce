#include "server/broad_phase/sweep_and_prune/sweep_and_prune.hpp"

#include <algorithm>
#include <limits>

#include "server/broad_phase/sweep_and_prune/sweep_pairs.hpp"

namespace collided::engine {
namespace {

/// A full sort costs about this many swaps per box; beyond it, sorting from the last order is given up.
constexpr std::uint64_t kSwapsABox = 16;

/// Another axis must be better by this factor, because a change of axis needs a full sort.
constexpr double kWorthChanging = 2;

}  // namespace

/// The axis along which the boxes are spread farthest for their size: fewest overlap there. Unbounded boxes do not
/// count.
int SweepAndPrune::best_axis(std::span<const Aabb> boxes) const {
  Aabb middles;
  Vec3 size = Vec3::Zero();
  for (const Aabb& box : boxes) {
    const Vec3 extent = box.high - box.low;
    if (box.empty() || !extent.allFinite()) continue;
    size += extent;
    middles.extend((box.low / 2 + box.high / 2).eval());
  }
  if (middles.empty()) return report_.axis;
  const Vec3 spread = middles.high - middles.low;
  int best = report_.axis;
  const auto crowd = [&](int axis) { return size[axis] / std::max(spread[axis], std::numeric_limits<double>::min()); };
  for (int axis = 0; axis < 3; ++axis) {
    if (crowd(axis) * kWorthChanging < crowd(best)) best = axis;
  }
  return best;
}

void SweepAndPrune::start_anew(std::span<const Aabb> boxes, int axis) {
  order_.clear();
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty()) order_.push_back({boxes[i].low[axis], i});
  }
  std::sort(order_.begin(), order_.end(), [](const Place& a, const Place& b) { return a.low < b.low; });
  box_count_ = boxes.size();
  report_ = {.axis = axis, .swaps = 0, .is_sorted_anew = true};
}

/// Insertion sort from the last order. False if so much has moved that a full sort is cheaper.
bool SweepAndPrune::sort_from_last() {
  const std::uint64_t most = kSwapsABox * order_.size();
  report_.swaps = 0;
  report_.is_sorted_anew = false;
  for (std::size_t i = 1; i < order_.size(); ++i) {
    const Place place = order_[i];
    std::size_t to = i;
    for (; to > 0 && place.low < order_[to - 1].low; --to) order_[to] = order_[to - 1];
    order_[to] = place;
    report_.swaps += i - to;
    if (report_.swaps > most) return false;
  }
  return true;
}

void SweepAndPrune::update(std::span<const Aabb> boxes) {
  const int axis = best_axis(boxes);
  bool is_known = boxes.size() == box_count_ && axis == report_.axis;
  std::size_t full = 0;
  for (const Aabb& box : boxes) full += box.empty() ? 0 : 1;
  is_known = is_known && full == order_.size();
  for (std::size_t i = 0; i < order_.size() && is_known; ++i) {
    is_known = !boxes[order_[i].number].empty();
    order_[i].low = boxes[order_[i].number].low[axis];
  }
  if (!is_known || !sort_from_last()) start_anew(boxes, axis);

  const auto count = static_cast<std::uint32_t>(order_.size());
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  blocks_.resize(count / BoxBlock::kSize + 1);
  numbers_.resize(blocks_.size() * BoxBlock::kSize);
  for (std::uint32_t place = 0; place < numbers_.size(); ++place) {
    const bool is_box = place < count;
    numbers_[place] = is_box ? order_[place].number : 0;
    const Aabb nowhere{Vec3::Constant(kNowhere), Vec3::Constant(kNowhere)};
    blocks_[place / BoxBlock::kSize].set(place % BoxBlock::kSize, is_box ? boxes[numbers_[place]] : nowhere);
  }
}

void SweepAndPrune::clear() {
  order_.clear();
  box_count_ = 0;
}

void SweepAndPrune::pairs(PairFound found, WalkCost& cost) const {
  sweep::find_pairs({blocks_, numbers_, static_cast<std::uint32_t>(order_.size()), report_.axis}, found, cost);
}

std::size_t SweepAndPrune::bytes() const {
  return order_.capacity() * sizeof(Place) + blocks_.capacity() * sizeof(BoxBlock) +
         numbers_.capacity() * sizeof(std::uint32_t);
}

}  // namespace collided::engine
