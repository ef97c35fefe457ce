#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "server/service/runtime/crew.hpp"
#include "server/service/runtime/named_thread.hpp"
#include "server/service/runtime/ring.hpp"

namespace collided::engine::service {

/// Work for several threads, in order of arrival. push() does not enforce the limit: ask has_room() first.
///
/// threads  any
template <class Item>
class WorkQueue {
 public:
  explicit WorkQueue(std::size_t limit) : limit_(limit) {}

  /// Runs a thread of its own that takes the items, one after the other; it is started when the first one comes.
  ///
  /// name  as for named_thread()
  void serve(const char* name, std::function<void(Item)> take) {
    const std::lock_guard lock(mutex_);
    crew_.emplace(1, [this, name, take = std::move(take)] {
      return [this, name, take] {
        serve_here(name, [&] {
          while (std::optional<Item> item = pop()) take(std::move(*item));
        });
      };
    });
  }

  /// False once the queue is closed, or if no thread can be started: the item would never be taken.
  bool push(Item item) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return false;
      if (crew_ && !crew_->grow()) return false;
      items_.push_back(std::move(item));
      size_.fetch_add(1, std::memory_order_relaxed);
    }
    arrived_.notify_one();
    return true;
  }
  bool empty() const { return size_.load(std::memory_order_relaxed) == 0; }
  bool has_room() const { return size_.load(std::memory_order_relaxed) < limit_; }
  /// Waits for an item; nothing once the queue is closed and empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return closed_ || !empty(); });
    if (empty()) return std::nullopt;
    size_.fetch_sub(1, std::memory_order_relaxed);
    return items_.pop_front();
  }
  /// Ends the waiting in pop(), which still returns the remaining items.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    arrived_.notify_all();
  }
  /// Closes it, and waits until its thread has taken the remaining items.
  void finish() {
    close();
    if (crew_) crew_->join();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  Ring<Item> items_;
  std::atomic<std::size_t> size_{0};  // read without the lock where it need not be exact
  std::size_t limit_;
  bool closed_ = false;
  std::optional<Crew> crew_;
};

}  // namespace collided::engine::service
