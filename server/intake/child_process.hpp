#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace collided::engine {

/// How a child process ended, and what it printed.
struct ChildResult {
  std::string output;         // first kMaxChildText bytes of its output; the rest is dropped
  std::string errors;         // the same part of its error stream
  int exit_code = -1;         // -1 if it did not exit by itself
  int signal = 0;             // signal that ended it, or 0
  bool timed_out = false;     // it was ended at the time limit
  bool cancelled = false;     // it was ended because the caller cancelled
  std::string start_failure;  // why it could not be started; empty: it was started
};

/// Limit of the bytes kept from each of a child's two streams.
inline constexpr std::size_t kMaxChildText = 64 * 1024;

/// Runs a program to its end in a process group of its own, and captures its output. Returns when it has ended.
///
/// words      path of the program, then its arguments; they pass through no shell
/// cancelled  called every 50 ms; true ends the whole group, as does the time limit
/// input      the child's stdin: a file in memory, so that neither process waits for the other
ChildResult run_child(const std::vector<std::string>& words, std::chrono::milliseconds time_limit,
                      const std::function<bool()>& cancelled, std::span<const std::byte> input = {});

}  // namespace collided::engine
