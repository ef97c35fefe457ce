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

/// The moves of one object, ordered by to_ns: added at the end, forgotten at the beginning. Stored in blocks, so that
/// growing copies nothing: the arrays of objects that began to move together would all be reallocated in the same step.
class MoveLog {
 public:
  bool empty() const { return blocks_.empty(); }
  const Move& front() const { return blocks_.front()[forgotten_]; }
  const Move& back() const { return blocks_.back().back(); }

  void push_back(const Move& move);
  /// True if the next move begins a block.
  bool is_full() const { return blocks_.empty() || blocks_.back().size() == blocks_.back().capacity(); }
  /// Forgets the first move.
  void pop_front();
  /// The last move of the first block; null if that is the only block.
  const Move* end_of_first_block() const { return blocks_.size() > 1 ? &blocks_.front().back() : nullptr; }
  /// Forgets the first of two or more blocks. Returns its number of moves.
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

  /// The current or next move at that time, and the one before it; null if there is none. If several end at one time,
  /// the last counts.
  struct Around {
    const Move* before = nullptr;
    const Move* next = nullptr;
  };
  Around around(std::int64_t time_ns) const;

 private:
  std::vector<std::vector<Move>> blocks_;  // none of them empty
  std::size_t forgotten_ = 0;              // moves of the first block
};

}  // namespace collided::engine
