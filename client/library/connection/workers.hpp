#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace collided::client {

/// A few threads that run tasks in order of arrival. A thread is started when a task needs it. The destructor waits
/// until all tasks have run. Any thread.
class Workers {
 public:
  static constexpr std::size_t kThreads = 4;  // may exceed the number of cores, since tasks mostly wait
  static constexpr std::size_t kMostWaiting = 1'024;

  ~Workers();
  /// Queues a task; false if kMostWaiting are waiting.
  bool run(std::function<void()> task);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::thread> threads_;
  bool ending_ = false;
};

}  // namespace collided::client
