#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/geometry/pose.hpp"

namespace collided::engine {

/// An object rested up to from_ns and moved to the pose until to_ns, world time; both equal: it jumped.
struct Move {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Pose pose;
};

/// The moves of one object, ordered by to_ns: added at the end, forgotten at the beginning. In blocks, so that growing
/// copies nothing: of objects that began to move together, arrays would all outgrow their memory in the same step.
class MoveLog {
 public:
  bool empty() const { return blocks_.empty(); }
  const Move& front() const { return blocks_.front()[forgotten_]; }
  const Move& back() const { return blocks_.back().back(); }

  void push_back(const Move& move);
  /// Whether the next move begins a block.
  bool is_full() const { return blocks_.empty() || blocks_.back().size() == blocks_.back().capacity(); }
  /// Forgets the first move.
  void pop_front();
  /// The last move of the first block; null where that is the only one.
  const Move* end_of_first_block() const { return blocks_.size() > 1 ? &blocks_.front().back() : nullptr; }
  /// Forgets the first block, of two or more. Returns how many moves it had.
  std::size_t pop_block();
  std::size_t size() const;

  /// Calls visit(move) for each, in order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    std::size_t first = forgotten_;
    for (const std::vector<Move>& block : blocks_) {
      for (; first < block.size(); ++first) visit(block[first]);
      first = 0;
    }
  }

  /// The move under way at that time or the next to begin, and the one before it; null where there is none. Of several
  /// that end at one time the last counts.
  struct Around {
    const Move* before = nullptr;
    const Move* next = nullptr;
  };
  Around around(std::int64_t time_ns) const;

 private:
  std::vector<std::vector<Move>> blocks_;  // none of them empty
  std::size_t forgotten_ = 0;              // of the first block
};

}  // namespace collided::engine
