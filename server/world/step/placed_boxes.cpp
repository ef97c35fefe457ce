#include "server/world/step/placed_boxes.hpp"

#include <algorithm>
#include <variant>

#include "server/geometry/placing_error.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {

void PlacedBoxes::forget() {
  for (const std::uint32_t slot : slots_) numbers_[slot] = kUnknown;
  slots_.clear();
  boxes_.clear();
}

void PlacedBoxes::begin_step(std::size_t slot_count) {
  forget();
  numbers_.resize(std::max(numbers_.size(), slot_count), kUnknown);
}

PlacedBoxPair PlacedBoxes::pair(const ObjectRows& rows, std::uint32_t first, std::uint32_t second) {
  const auto is_box = [&](std::uint32_t slot) {
    return numbers_[slot] != kUnknown || lone_box(*rows.info(slot)) != nullptr;
  };
  if (!is_box(first) || !is_box(second)) return {};
  if (boxes_.size() + 2 > kMost) forget();
  // The first must not move in memory while the second is added.
  if (boxes_.capacity() < boxes_.size() + 2) boxes_.reserve(std::min(2 * boxes_.size() + 2, kMost));
  return {&placed(rows, first), &placed(rows, second)};
}

const PlacedBox& PlacedBoxes::placed(const ObjectRows& rows, std::uint32_t slot) {
  if (numbers_[slot] != kUnknown) return boxes_[numbers_[slot]];
  const ObjectRow& row = rows[slot];
  const Primitive& own = rows.info(slot)->primitives.front();
  const Frame now = row.frame();
  const Frame before = rows.motion(slot) == Motion::moved ? row.frame_before(now) : now;
  numbers_[slot] = static_cast<std::uint32_t>(boxes_.size());
  slots_.push_back(slot);
  return boxes_.emplace_back(std::get<Box>(own), before, now, row.reach_m, placing_error_m(now, own));
}

}  // namespace collided::engine
