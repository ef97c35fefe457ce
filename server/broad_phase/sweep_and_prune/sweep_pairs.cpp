#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/sweep_and_prune/sweep_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "server/broad_phase/box_block-inl.hpp"
#include "server/broad_phase/sweep_and_prune/sweep_pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::sweep::HWY_NAMESPACE {

constexpr std::uint32_t kBlock = BoxBlock::kSize;

/// Compares every box with those that begin, on the axis, before it ends. The NaN after the last box ends the search.
void FindPairs(const Ordered& ordered, SweepAndPrune::PairFound found, WalkCost& cost) {
  const std::uint32_t* numbers = ordered.numbers.data();
  for (std::uint32_t place = 0; place < ordered.count; ++place) {
    const BoxBlock& own = ordered.blocks[place / kBlock];
    const engine::HWY_NAMESPACE::AskedBox asked(own, place % kBlock);
    const double end = own.high[ordered.axis][place % kBlock];
    // First those after the box in its own block, then whole blocks.
    unsigned wanted = 0xfeu << place % kBlock & 0xffu;
    for (std::uint32_t block = place / kBlock;; wanted = 0xffu) {
      for (unsigned met = asked.overlapping(ordered.blocks[block]) & wanted; met != 0; met &= met - 1) {
        ++cost.candidates;
        const std::uint32_t a = numbers[place];
        const std::uint32_t b = numbers[block * kBlock + static_cast<std::uint32_t>(__builtin_ctz(met))];
        if (!found(std::min(a, b), std::max(a, b))) return;
      }
      if (++block == ordered.blocks.size() || !(ordered.blocks[block].low[ordered.axis][0] <= end)) break;
    }
  }
}

}  // namespace collided::engine::sweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::sweep {

HWY_EXPORT(FindPairs);

void find_pairs(const Ordered& ordered, SweepAndPrune::PairFound found, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(FindPairs)(ordered, found, cost);
}

}  // namespace collided::engine::sweep
#endif
