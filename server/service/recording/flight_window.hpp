#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace collided::engine::service {

/// The newest records, in reused blocks of memory. Records that leave the window are passed out once more. Memory is
/// allocated on demand, at most kBlocks * kBlockBytes, and that of expired blocks is returned.
///
/// threads  one; for_each_block() also from a signal handler of the same process, while nothing is added
class FlightWindow {
 public:
  static constexpr std::size_t kBlocks = 32;
  static constexpr std::size_t kBlockBytes = std::size_t{2} << 20;  // twice the size of the largest message

  /// leave  called with the records of the oldest block before its memory is reused
  FlightWindow(std::uint64_t window_ns, std::function<void(std::span<const std::byte>)> leave)
      : window_ns_(window_ns), leave_(std::move(leave)) {}

  /// Adds the record of an MCAP message, in the format of flight_ring.hpp, of at most a block. log_time: ns since 1970.
  void add(std::span<const std::byte> record, std::uint64_t log_time);
  /// Drops the blocks whose records are all older than the window. now: ns since 1970.
  void expire(std::uint64_t now);

  /// Memory held: that of the most blocks ever in use at once.
  std::size_t held_bytes() const;

  /// Calls see(records, first log time, last log time) for each block, oldest first.
  template <class See>
  void for_each_block(See&& see) const {
    const std::size_t first = first_.load(std::memory_order_acquire);
    const std::size_t count = count_.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < count; ++i) {
      const Block& block = blocks_[(first + i) % kBlocks];
      const std::size_t used = block.used.load(std::memory_order_acquire);
      if (used > 0) see(std::span<const std::byte>(block.bytes.get(), used), block.first_time, block.last_time);
    }
  }

 private:
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::atomic<std::size_t> used{0};
    std::uint64_t first_time = 0, last_time = 0;
  };
  Block& newest() { return blocks_[(first_ + count_ - 1) % kBlocks]; }
  void open_block(std::uint64_t log_time);
  void drop_oldest();
  std::unique_ptr<std::byte[]> memory_of_a_free_block();

  const std::uint64_t window_ns_;
  std::function<void(std::span<const std::byte>)> leave_;
  std::array<Block, kBlocks> blocks_;
  std::atomic<std::size_t> first_{0}, count_{0};  // blocks in use, around the end of the array
};

}  // namespace collided::engine::service
