#pragma once

#include <cstdint>
#include <span>

#include "server/broad_phase/sweep_and_prune/sweep_and_prune.hpp"

namespace collided::engine::sweep {

/// Boxes in the order of their low ends on an axis; lanes after the last box are NaN.
struct Ordered {
  std::span<const BoxBlock> blocks;
  std::span<const std::uint32_t> numbers;
  std::uint32_t count;
  int axis;
};

/// Same as SweepAndPrune::pairs; SIMD, chosen at run time.
void find_pairs(const Ordered& ordered, SweepAndPrune::PairFound found, WalkCost& cost);

}  // namespace collided::engine::sweep
