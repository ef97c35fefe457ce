#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/step/separation_cache.hpp"
#include "server/world/world.hpp"

namespace collided::engine {

/// One item of a step's work: two objects, or a mover and a static scene.
struct StepItem {
  static constexpr std::uint32_t kPair = 0xffffffff;
  std::uint32_t first = 0;  // slot; the mover's if with a scene
  std::uint32_t second = 0;
  std::uint32_t scene = kPair;  // its number, or kPair
};

/// A recorded change of the ledger, made later.
struct LedgerWrite {
  enum class Kind : std::uint8_t {
    touches,
    parts,
    changes_containment,
    doubts,
    doubted_and_parted,
    decided_apart,
    touched_and_parted
  };
  Kind kind = Kind::touches;
  EndReason reason = EndReason::none;  // for parts and changes_containment
  Doubt why = Doubt::none;
  FoundContact found;  // for parts, changes_containment and decided_apart: only the pair, the bracket and `contained`
};

/// A run of a step's items that one thread decides, and its findings in order.
struct StepBlock {
  static constexpr std::size_t kMost = 64;  // items

  std::vector<StepItem> items;
  std::vector<LedgerWrite> writes;
  std::vector<GapFound> gaps;
  StepCost cost;

  void clear() {
    items.clear();
    writes.clear();
    gaps.clear();
    cost = {};
  }
};

/// Limit of blocks in progress: their findings take some megabytes at most.
using StepBlocks = std::array<StepBlock, 256>;

}  // namespace collided::engine
