#include "server/service/recording/flight_window.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace collided::engine::service {

void FlightWindow::add(std::span<const std::byte> record, std::uint64_t log_time) {
  // A block also ends after a sixteenth of the window: only whole blocks leave, so the window is never much too long.
  constexpr std::uint64_t kBlocksAWindow = 16;
  const bool room = count_ > 0 && newest().used + record.size() <= kBlockBytes;
  if (!room || log_time > newest().first_time + window_ns_ / kBlocksAWindow) open_block(log_time);
  Block& block = newest();
  std::memcpy(block.bytes.get() + block.used, record.data(), record.size());
  block.last_time = std::max(block.last_time, log_time);
  block.used.store(block.used + record.size(), std::memory_order_release);
}

void FlightWindow::open_block(std::uint64_t log_time) {
  if (count_ == kBlocks) drop_oldest();
  Block& block = blocks_[(first_ + count_) % kBlocks];
  if (!block.bytes) block.bytes = memory_of_a_free_block();
  block.used.store(0);
  block.first_time = block.last_time = log_time;
  count_.store(count_ + 1, std::memory_order_release);
}

std::unique_ptr<std::byte[]> FlightWindow::memory_of_a_free_block() {
  for (std::size_t i = count_; i < kBlocks; ++i) {
    Block& free = blocks_[(first_ + i) % kBlocks];
    if (free.bytes) return std::move(free.bytes);
  }
  return std::unique_ptr<std::byte[]>(new std::byte[kBlockBytes]);  // not zeroed: pages are allocated when written
}

std::size_t FlightWindow::held_bytes() const {
  const auto has_memory = [](const Block& block) { return block.bytes != nullptr; };
  return kBlockBytes * static_cast<std::size_t>(std::count_if(blocks_.begin(), blocks_.end(), has_memory));
}

void FlightWindow::drop_oldest() {
  const Block& block = blocks_[first_];
  leave_({block.bytes.get(), block.used});
  first_.store((first_ + 1) % kBlocks);
  count_.store(count_ - 1);
}

/// A block that is no longer needed stays mapped, since a signal's handler may be reading it, but gives its pages back.
void FlightWindow::expire(std::uint64_t now) {
  while (count_ > 0 && blocks_[first_].last_time + window_ns_ < now) {
    const Block& block = blocks_[first_];
    drop_oldest();
    void* begin = block.bytes.get();
    std::size_t room = kBlockBytes;
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    if (std::align(page, page, begin, room) != nullptr) madvise(begin, room / page * page, MADV_DONTNEED);
  }
}

}  // namespace collided::engine::service
