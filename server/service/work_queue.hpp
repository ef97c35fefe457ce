#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace collided::service {

/// Work for several threads, in order of arrival. The bound is kept by who pushes: see has_room().
template <class Item>
class WorkQueue {
 public:
  explicit WorkQueue(std::size_t limit) : limit_(limit) {}

  void push(Item item) {
    {
      const std::lock_guard lock(mutex_);
      items_.push_back(std::move(item));
    }
    arrived_.notify_one();
  }
  bool empty() const {
    const std::lock_guard lock(mutex_);
    return items_.empty();
  }
  bool has_room() const {
    const std::lock_guard lock(mutex_);
    return items_.size() < limit_;
  }
  /// Waits; nothing once the queue is closed and empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<Item> item(std::move(items_.front()));
    items_.pop_front();
    return item;
  }
  /// What is in is still handed out.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    arrived_.notify_all();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Item> items_;
  std::size_t limit_;
  bool closed_ = false;
};

}  // namespace collided::service
