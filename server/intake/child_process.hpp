#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace collided::engine {

struct ChildResult {
  std::string output;  // at most kMaxChildText of each, the rest is dropped
  std::string errors;
  int exit_code = -1;  // -1 when it did not end by itself
  int signal = 0;      // that ended it, or 0
  bool timed_out = false;
  bool cancelled = false;
  std::string start_failure;  // why it could not be started, or nothing
};

inline constexpr std::size_t kMaxChildText = 64 * 1024;

/// Runs a program to its end in a process group of its own, and catches what it prints.
///
/// words      path of the program, then its arguments; no shell looks at them
/// cancelled  asked every 50 ms; true ends the whole group, as does the time limit
/// input      what it finds on its stdin: a file in memory, so that neither has to wait for the other
ChildResult run_child(const std::vector<std::string>& words, std::chrono::milliseconds time_limit,
                      const std::function<bool()>& cancelled, std::span<const std::byte> input = {});

}  // namespace collided::engine
