#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>

#include "server/service/runtime/fair_queue.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// Threads for commands that take long, each of which does one job after the other: loads and menus on one, pairs on
/// the second. A costly pair goes on to the third, which also writes recordings, so that no cheap one waits behind it.
class CommandThreads {
 public:
  using Job = std::function<void()>;

  CommandThreads();
  ~CommandThreads() { stop(); }

  /// Throws BadCommand if too many slow jobs wait.
  void require_room(const char* what) const;
  /// False: the system has no room for the thread, or stop() was called. The job is dropped.
  [[nodiscard]] bool push_slow(Job job) { return slow_jobs_.push(std::move(job)); }
  static constexpr const char* kNoThread = "the system has no room for another thread, or the server is stopping";
  /// These throw BadCommand if too many jobs wait, of all clients or of this one.
  void push_pair(const char* what, const Share& share, Job job) { push(what, pair_jobs_, share, std::move(job)); }
  void push_costly(const char* what, const Share& share, Job job) { push(what, costly_jobs_, share, std::move(job)); }

  /// Jobs under way may end early after this call.
  void begin_stop() { stopping_.store(true); }
  bool are_stopping() const { return stopping_.load(); }
  /// Does the waiting jobs and ends the threads.
  void stop();

 private:
  static constexpr std::size_t kMostSlowJobs = 4;    // waiting
  static constexpr std::size_t kMostPairJobs = 128;  // waiting, half of them at most by one client

  static void push(const char* what, FairQueue<Job>& jobs, const Share& share, Job job);

  WorkQueue<Job> slow_jobs_{kMostSlowJobs};
  FairQueue<Job> pair_jobs_{kMostPairJobs};
  FairQueue<Job> costly_jobs_{kMostPairJobs};
  std::atomic<bool> stopping_{false};
};

}  // namespace collided::engine::service
