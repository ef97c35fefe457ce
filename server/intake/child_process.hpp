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
  std::string output;         // its first kMaxChildText bytes; the rest is dropped
  std::string errors;         // the same of its error stream
  int exit_code = -1;         // -1 where it did not end by itself
  int signal = 0;             // that ended it, or 0
  bool timed_out = false;     // it was ended at the time limit
  bool cancelled = false;     // it was ended since the caller asked for that
  std::string start_failure;  // why it could not be started; empty: it was
};

/// Bytes that are kept of each of a child's two streams.
inline constexpr std::size_t kMaxChildText = 64 * 1024;

/// Runs a program to its end in a process group of its own, and catches what it prints. Returns when it has ended.
///
/// words      path of the program, then its arguments; they pass through no shell
/// cancelled  called every 50 ms; true ends the whole group, as does the time limit
/// input      what the child reads from stdin: a file in memory, so that neither process waits for the other
ChildResult run_child(const std::vector<std::string>& words, std::chrono::milliseconds time_limit,
                      const std::function<bool()>& cancelled, std::span<const std::byte> input = {});

}  // namespace collided::engine
