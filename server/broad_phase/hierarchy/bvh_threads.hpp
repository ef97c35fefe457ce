#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace collided::engine::bvh {

/// The requested number, or one per core for 0.
inline unsigned thread_count(unsigned asked) {
  return asked != 0 ? asked : std::max(1u, std::thread::hardware_concurrency());
}

/// Calls work(i, callers_thread) once for each i in [0, count), on several threads including the caller's; rethrows the
/// first exception.
template <typename Work>
void in_parallel(unsigned threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::atomic<bool> failed{false};
  const auto run = [&](bool callers_thread) {
    try {
      for (std::size_t i = next++; i < count && !failed; i = next++) work(i, callers_thread);
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      for (unsigned i = 1; i < threads && i < count; ++i) helpers.emplace_back(run, false);
    } catch (const std::system_error&) {
      // There is no memory for another stack: fewer threads do the work.
    }
    run(true);
  }
  if (failure) std::rethrow_exception(failure);
}

/// Covers [0, size) in runs: work(begin, end).
template <typename Work>
void in_runs(unsigned threads, std::size_t size, std::size_t run, const Work& work) {
  in_parallel(threads, (size + run - 1) / run,
              [&](std::size_t i, bool) { work(i * run, std::min((i + 1) * run, size)); });
}

}  // namespace collided::engine::bvh
