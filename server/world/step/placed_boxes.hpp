#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/placed_box.hpp"

namespace collided::engine {

/// Two objects of one box each; null for any other object.
struct PlacedBoxPair {
  const PlacedBox* a = nullptr;
  const PlacedBox* b = nullptr;

  bool are_boxes() const { return a != nullptr; }
};

/// Objects of one box each that a step decides, placed once for many candidates.
/// threads  the writer only
class PlacedBoxes {
 public:
  /// More are not remembered (1.2 MB of them): candidates come in spatial order, so a forgotten one is seldom needed
  /// again.
  static constexpr std::size_t kMost = 4'096;

  /// Forgets the boxes of the last step.
  void begin_step(std::size_t slot_count);
  /// Valid until the next call. The rows must not change within the step.
  PlacedBoxPair pair(const ObjectRows& rows, std::uint32_t first, std::uint32_t second);

 private:
  static constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();

  void forget();
  const PlacedBox& placed(const ObjectRows& rows, std::uint32_t slot);

  std::vector<PlacedBox> boxes_;
  std::vector<std::uint32_t> slots_;    // slots of boxes_
  std::vector<std::uint32_t> numbers_;  // indexes into boxes_, by slot
};

}  // namespace collided::engine
