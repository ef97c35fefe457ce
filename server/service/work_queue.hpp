#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

#include "server/service/ring.hpp"

namespace collided::service {

/// Work for several threads, in order of arrival but for what is short. The bound is kept by who pushes: see
/// has_room().
template <class Item>
class WorkQueue {
 public:
  explicit WorkQueue(std::size_t limit) : limit_(limit) {}

  void push(Item item) { push(usual_, std::move(item)); }
  /// Before all that was pushed as usual, so that what takes microseconds does not wait for what takes milliseconds.
  void push_short(Item item) { push(short_, std::move(item)); }
  bool empty() const { return size_.load(std::memory_order_relaxed) == 0; }
  bool has_room() const { return size_.load(std::memory_order_relaxed) < limit_; }
  /// Waits; nothing once the queue is closed and empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return closed_ || !empty(); });
    if (empty()) return std::nullopt;
    size_.fetch_sub(1, std::memory_order_relaxed);
    const bool usual_has_waited = !usual_.empty() && short_in_a_row_ >= kMostShortInARow;
    const bool take_short = !short_.empty() && !usual_has_waited;
    short_in_a_row_ = take_short ? short_in_a_row_ + 1 : 0;
    return (take_short ? short_ : usual_).pop_front();
  }
  /// What is in is still handed out.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    arrived_.notify_all();
  }

 private:
  static constexpr int kMostShortInARow = 16;  // however many come, what is long gets its turn

  void push(Ring<Item>& lane, Item item) {
    {
      const std::lock_guard lock(mutex_);
      lane.push_back(std::move(item));
      size_.fetch_add(1, std::memory_order_relaxed);
    }
    arrived_.notify_one();
  }

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  Ring<Item> usual_;
  Ring<Item> short_;
  std::atomic<std::size_t> size_{0};  // of both; read without the lock where it need not be exact
  std::size_t limit_;
  int short_in_a_row_ = 0;
  bool closed_ = false;
};

}  // namespace collided::service
