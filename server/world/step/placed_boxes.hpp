#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/placed_box.hpp"

namespace collided::engine {

/// Two objects of one box each; null where one of them is anything else.
struct PlacedBoxPair {
  const PlacedBox* a = nullptr;
  const PlacedBox* b = nullptr;

  bool are_boxes() const { return a != nullptr; }
};

/// The objects that are one box each and that a step decides, each placed once for many candidates.
/// threads  the writer's only
class PlacedBoxes {
 public:
  /// More are not remembered, 1.2 MB of them: candidates come in the order of space, so that one that was forgotten is
  /// seldom asked for again.
  static constexpr std::size_t kMost = 4'096;

  /// Forgets the last step's.
  void begin_step(std::size_t slot_count);
  /// Valid until the next call. The rows must not change within the step.
  PlacedBoxPair pair(const ObjectRows& rows, std::uint32_t first, std::uint32_t second);

 private:
  static constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();

  void forget();
  const PlacedBox& placed(const ObjectRows& rows, std::uint32_t slot);

  std::vector<PlacedBox> boxes_;
  std::vector<std::uint32_t> slots_;    // of boxes_
  std::vector<std::uint32_t> numbers_;  // in boxes_, by slot
};

}  // namespace collided::engine
