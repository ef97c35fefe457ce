#include "client/library/recordings/recording_queue.hpp"

namespace collided::client {

void RecordingQueue::take(Batch& batch, std::chrono::nanoseconds wait) {
  batch.entries.clear();
  batch.bytes.clear();
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, wait, [this] { return woken_ || waiting_.bytes.size() >= kWakeBytes; });
  std::swap(batch, waiting_);
}

void RecordingQueue::wake() {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  came_.notify_one();
}

std::array<std::uint64_t, RecordingQueue::kChannels> RecordingQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace collided::client
