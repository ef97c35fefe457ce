#include "server/intake/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace collided::engine {
namespace {

struct ParallelRun {
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  std::mutex failure_mutex;
  std::size_t failed_task = 0;
  std::exception_ptr failure;

  void fail(std::size_t task) {
    const std::lock_guard lock(failure_mutex);
    if (!failure || task < failed_task) {
      failed_task = task;
      failure = std::current_exception();
    }
  }
};

}  // namespace

void run_in_parallel(std::size_t task_count, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& between) {
  ParallelRun run;
  // Tasks are handed out in order, so when one fails, all with smaller numbers have been started and their failures
  // will be seen.
  const auto take_one = [&] {
    const std::size_t index = run.next.fetch_add(1);
    if (index >= task_count) { return false; }
    try {
      task(index);
      run.done.fetch_add(1);
      return true;
    } catch (...) {
      run.fail(index);
      run.next.store(task_count);
      return false;
    }
  };
  std::exception_ptr stopped;
  {
    const std::size_t core_count = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> helpers;
    try {
      for (std::size_t i = 1; i < std::min(core_count, task_count); ++i) {
        helpers.emplace_back([&] {
          while (take_one()) {}
        });
      }
    } catch (const std::system_error&) {
      // There is no memory for another stack: fewer threads do the work.
    }
    try {
      while (take_one()) { between(run.done.load()); }
    } catch (...) {
      stopped = std::current_exception();
      run.next.store(task_count);
    }
  }
  if (stopped) { std::rethrow_exception(stopped); }
  if (run.failure) { std::rethrow_exception(run.failure); }
}

}  // namespace collided::engine
