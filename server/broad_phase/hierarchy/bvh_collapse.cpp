#include "server/broad_phase/hierarchy/bvh_collapse.hpp"

#include <algorithm>
#include <limits>

namespace collided::engine::bvh {
namespace {

/// Cuts by the surface-area heuristic to this depth, then by count.
constexpr std::uint32_t kMostHeuristicCuts = 24;
static_assert(kMostHeuristicCuts + 12 <= Collapse::kMostDepth && Collapse::kMostPrimitives <= 1u << 11);

}  // namespace

void Collapse::cut(std::span<Primitive> primitives, const Range& range) {
  parts_.clear();
  cut_further(primitives, range, 0);
}

int Collapse::cut_further(std::span<Primitive> primitives, const Range& range, std::uint32_t depth) {
  const int index = static_cast<int>(parts_.size());
  parts_.emplace_back().range = range;
  Part part;
  part.range = range;
  if (range.size() > kWidth) {
    Range left;
    Range right;
    part.axis = split(primitives, range, depth >= kMostHeuristicCuts, left, right);
    part.left = cut_further(primitives, left, depth + 1);
    part.right = cut_further(primitives, right, depth + 1);
  }
  weigh(part);
  parts_[static_cast<std::size_t>(index)] = part;
  return index;
}

/// Leaves are the same however the cuts above them are merged, so only nodes are weighted.
void Collapse::weigh(Part& part) const {
  if (part.left < 0) return;
  const auto& left = parts_[static_cast<std::size_t>(part.left)].cost;
  const auto& right = parts_[static_cast<std::size_t>(part.right)].cost;
  std::array<float, kWidth + 1> divided;
  for (int room = 2; room <= kWidth; ++room) {
    auto& best = divided[static_cast<std::size_t>(room)];
    best = std::numeric_limits<float>::infinity();
    for (int to_left = std::max(1, room - kWidth + 1); to_left < std::min(room, kWidth); ++to_left) {
      const float cost = left[static_cast<std::size_t>(to_left)] + right[static_cast<std::size_t>(room - to_left)];
      if (cost >= best) continue;
      best = cost;
      part.to_left[static_cast<std::size_t>(room)] = static_cast<std::uint8_t>(to_left);
    }
  }
  part.cost[1] = part.range.bounds.half_area() + divided[kWidth];
  for (std::size_t room = 2; room < kWidth; ++room) {
    part.cost[room] = std::min(divided[room], part.cost[room - 1]);
    if (part.cost[room - 1] <= divided[room]) part.to_left[room] = 0;
  }
}

int Collapse::children(int part, int (&out)[kWidth], Cut (&cuts)[kWidth]) const {
  int count = 1;
  gather(part, kWidth, 0, out, cuts, count);
  return count;
}

/// Writes the children into which a part is divided, given room for this many: the part itself, or its two sides.
void Collapse::gather(int part, int room, int at, int (&out)[kWidth], Cut (&cuts)[kWidth], int& count) const {
  const Part& of = parts_[static_cast<std::size_t>(part)];
  while (room > 1 && of.to_left[static_cast<std::size_t>(room)] == 0) --room;
  if (room == 1 || of.left < 0) {
    out[at] = part;
    return;
  }
  const int to_left = of.to_left[static_cast<std::size_t>(room)];
  const int place = count++;
  cuts[place - 1] = {at, place, of.axis};
  gather(of.left, to_left, at, out, cuts, count);
  gather(of.right, room - to_left, place, out, cuts, count);
}

}  // namespace collided::engine::bvh
