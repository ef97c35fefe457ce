#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "idl/dds.hpp"

namespace collided::client {

/// A pool of samples with reused buffers, so that taking a message of usual size does not allocate. Any thread.
template <class T>
class SamplePool {
 public:
  using Pointer = std::unique_ptr<dds::Sample<T>>;

  /// Returns a sample, which may contain an old message.
  Pointer get() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) { return std::make_unique<dds::Sample<T>>(); }
    Pointer sample = std::move(idle_.back());
    idle_.pop_back();
    return sample;
  }

  /// Returns a sample to the pool, which keeps up to kMostIdle.
  void put(Pointer sample) {
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMostIdle) { idle_.push_back(std::move(sample)); }
  }

 private:
  static constexpr std::size_t kMostIdle = 64;  // bounds the memory after a burst
  std::mutex mutex_;
  std::vector<Pointer> idle_;
};

}  // namespace collided::client
