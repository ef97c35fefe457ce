#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "idl/topics.hpp"

namespace collided::client {

/// The pose batches whose receipt by the server is not confirmed. The writer keeps a fixed number of batches: one more
/// would displace a batch that the server lacks, perhaps with the only pose of an object. Large batches fill socket
/// buffers sooner, so their bytes are limited too.
///
/// threads  one at a time
class UnacknowledgedPoses {
 public:
  static constexpr std::size_t kMostBatches = wire_contract::kPoseTopic.keep_last - 8;
  static constexpr std::size_t kMostBytes = 14'000'000;

  /// True: no more may be written until the server has confirmed some batches.
  bool is_full() const { return count_ >= kMostBatches || bytes_ >= kMostBytes; }
  std::size_t batches() const { return count_; }
  /// Adds a batch.
  /// sequence  its number, or that of the previous message if it has none
  void note_written(std::uint64_t sequence, std::size_t bytes) {
    batches_[(first_ + count_++) % batches_.size()] = {sequence, bytes};
    bytes_ += bytes;
  }
  /// Removes the batches up to this number, which the server has.
  void note_known(std::uint64_t sequence) {
    while (count_ > 0 && batches_[first_].sequence <= sequence) {
      bytes_ -= batches_[first_].bytes;
      first_ = (first_ + 1) % batches_.size();
      --count_;
    }
  }
  void note_all_known() { note_known(std::numeric_limits<std::uint64_t>::max()); }

 private:
  struct Batch {
    std::uint64_t sequence = 0;
    std::size_t bytes = 0;
  };
  std::array<Batch, kMostBatches> batches_{};  // a ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace collided::client
