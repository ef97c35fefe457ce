#pragma once

#include <cstddef>
#include <functional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// The threads that take work out of a queue. One is started when work waits for which no other is free, so an idle
/// server has few.
///
/// threads  as the queue's lock guards it; join() without the lock, once the queue is closed
class Crew {
 public:
  /// body  what each thread does: takes work until the queue is closed
  Crew(std::size_t most, std::function<void()> body) : most_(most), body_(std::move(body)) { threads_.reserve(most); }

  std::size_t most() const { return most_; }
  /// Threads that are not started yet.
  std::size_t spare() const { return most_ - threads_.size(); }
  /// Starts one, if there may be one more. False: none runs, since the system has no room for a thread.
  bool grow() {
    try {
      if (spare() > 0) threads_.emplace_back(body_);
    } catch (const std::system_error&) {
      // Those that run do the work, only later.
    }
    return !threads_.empty();
  }
  void join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::size_t most_;
  std::function<void()> body_;
  std::vector<std::thread> threads_;
};

}  // namespace collided::engine::service
