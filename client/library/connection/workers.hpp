#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace collided::client {

/// A few threads that run what is put in, in order of arrival; started with the first task. Any thread.
class Workers {
 public:
  static constexpr std::size_t kThreads = 4;  // a request waits most of its time, so more than cores
  static constexpr std::size_t kMostWaiting = 1'024;

  ~Workers();
  /// False when kMostWaiting tasks wait already.
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
