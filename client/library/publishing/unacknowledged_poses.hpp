#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "idl/topics.hpp"

namespace collided::client {

/// The pose batches that the server is not known to have. The writer keeps a number of them: one more would push out a
/// batch that the server has not got, and with it the only pose of some object. Large batches fill sockets before that, so
/// bytes count as well.
///
/// threads  one at a time
class UnacknowledgedPoses {
 public:
  static constexpr std::size_t kMostBatches = wire_contract::kPoseTopic.keep_last - 8;
  static constexpr std::size_t kMostBytes = 14'000'000;

  /// True: nothing more is to be written until the server is known to have some of it.
  bool is_full() const { return count_ >= kMostBatches || bytes_ >= kMostBytes; }
  /// sequence  grows from batch to batch; a batch without a number has that of the one before
  void note_written(std::uint64_t sequence, std::size_t bytes) {
    batches_[(first_ + count_++) % batches_.size()] = {sequence, bytes};
    bytes_ += bytes;
  }
  /// The server has everything up to here.
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
