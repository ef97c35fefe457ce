#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// The threads that take work out of a queue. One is started when work waits and no other is free, so an idle server
/// has few.
///
/// threads  guarded by the queue's lock; join() without the lock, once the queue is closed
class Crew {
 public:
  /// The work of one thread: takes items until the queue is closed.
  using Shift = std::function<void()>;
  /// begin  makes what a new thread needs, on the thread that adds the work, and returns the new one's shift
  Crew(std::size_t most, std::function<Shift()> begin) : most_(most), begin_(std::move(begin)) {
    threads_.reserve(most);
  }

  std::size_t most() const { return most_; }
  /// Threads not started yet.
  std::size_t spare() const { return most_ - threads_.size(); }
  /// Starts one, if the limit allows. False: none runs, since the system has no room or no memory for a thread.
  bool grow() {
    try {
      if (spare() > 0) threads_.emplace_back(begin_());
    } catch (const std::exception&) {
      // The running threads do the work, only later.
    }
    return !threads_.empty();
  }
  void join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::size_t most_;
  std::function<Shift()> begin_;
  std::vector<std::thread> threads_;
};

}  // namespace collided::engine::service
