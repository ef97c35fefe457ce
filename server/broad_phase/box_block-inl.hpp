// Compares one box with eight, for each instruction set. Included once per target, like Highway's own -inl files.
#if defined(COLLIDED_BOX_BLOCK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COLLIDED_BOX_BLOCK_INL
#undef COLLIDED_BOX_BLOCK_INL
#else
#define COLLIDED_BOX_BLOCK_INL
#endif

#include <hwy/highway.h>

#include "server/broad_phase/box_block.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A box to compare with others: each of its bounds in every lane.
class AskedBox {
 public:
  HWY_INLINE AskedBox(const BoxBlock& block, std::uint32_t lane)
      : low_{hn::Set(kDoubles, block.low[0][lane]), hn::Set(kDoubles, block.low[1][lane]),
             hn::Set(kDoubles, block.low[2][lane])},
        high_{hn::Set(kDoubles, block.high[0][lane]), hn::Set(kDoubles, block.high[1][lane]),
              hn::Set(kDoubles, block.high[2][lane])} {}

  /// One bit for each lane of the block that overlaps, touching included.
  HWY_INLINE unsigned overlapping(const BoxBlock& block) const {
    unsigned found = 0;
    for (std::uint32_t first = 0; first < BoxBlock::kSize; first += kLanes) {
      auto all = hn::Le(hn::Load(kDoubles, block.low[0] + first), high_[0]);
      all = hn::And(all, hn::Ge(hn::Load(kDoubles, block.high[0] + first), low_[0]));
      for (int axis = 1; axis < 3; ++axis) {
        all = hn::And(all, hn::Le(hn::Load(kDoubles, block.low[axis] + first), high_[axis]));
        all = hn::And(all, hn::Ge(hn::Load(kDoubles, block.high[axis] + first), low_[axis]));
      }
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(kDoubles, all, bits);
      found |= static_cast<unsigned>(bits[0]) << first;
    }
    return found;
  }

 private:
  using Doubles = hn::CappedTag<double, BoxBlock::kSize>;
  static constexpr Doubles kDoubles{};
  static constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(hn::MaxLanes(kDoubles));

  hn::Vec<Doubles> low_[3];
  hn::Vec<Doubles> high_[3];
};

}  // namespace collided::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
