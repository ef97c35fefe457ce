#include "server/world/query/move_log.hpp"

#include <algorithm>
#include <iterator>

namespace collided::engine {
namespace {

// Most objects move never or all the time: the first blocks are small, later ones take 1 to 2 KiB.
constexpr std::size_t kMostInBlock = 16;

}  // namespace

void MoveLog::push_back(const Move& move) {
  if (is_full()) {
    std::size_t room = blocks_.empty() ? 1 : std::min(kMostInBlock, 2 * blocks_.back().size());
    // Objects that began together would all need their next block in one step, so one block is shorter, by an amount
    // that depends on the log's address.
    if (!blocks_.empty() && 2 * blocks_.back().size() == kMostInBlock)
      room -= reinterpret_cast<std::uintptr_t>(this) / sizeof *this % (kMostInBlock / 2);
    blocks_.emplace_back().reserve(room);
  }
  blocks_.back().push_back(move);
}

void MoveLog::pop_front() {
  if (++forgotten_ < blocks_.front().size()) return;
  blocks_.erase(blocks_.begin());
  forgotten_ = 0;
}

std::size_t MoveLog::pop_block() {
  const std::size_t count = blocks_.front().size() - forgotten_;
  blocks_.erase(blocks_.begin());
  forgotten_ = 0;
  return count;
}

std::size_t MoveLog::size() const {
  std::size_t count = 0;
  for (const std::vector<Move>& block : blocks_) count += block.size();
  return count - forgotten_;
}

MoveLog::Around MoveLog::around(std::int64_t time_ns) const {
  const auto ends_later = [](std::int64_t time, const Move& move) { return time < move.to_ns; };
  const auto block = std::upper_bound(
      blocks_.begin(), blocks_.end(), time_ns,
      [&](std::int64_t time, const std::vector<Move>& moves) { return ends_later(time, moves.back()); });
  const Move* const last_before = block == blocks_.begin() ? nullptr : &std::prev(block)->back();
  if (block == blocks_.end()) return {.before = last_before, .next = nullptr};
  const auto first = block->begin() + static_cast<std::ptrdiff_t>(block == blocks_.begin() ? forgotten_ : 0);
  const auto next = std::upper_bound(first, block->end(), time_ns, ends_later);
  return {.before = next == first ? last_before : &*std::prev(next), .next = &*next};
}

}  // namespace collided::engine
