#pragma once

#include <chrono>

namespace collided::engine::service {

/// For threads that others wait for: those that read, and the world's.
inline constexpr std::chrono::nanoseconds kShortSlice = std::chrono::microseconds(100);
/// For threads that process batches; a thread with a shorter slice goes before them.
inline constexpr std::chrono::nanoseconds kLongSlice = std::chrono::milliseconds(20);

/// For threads with the longest tasks; within what the kernel accepts.
inline constexpr std::chrono::nanoseconds kLongestSlice = std::chrono::milliseconds(100);

/// Asks the kernel to run this thread, and those that it starts from then on, in slices of this length while processors
/// are short. A thread with a shorter slice than the running one need not wait for that one's end (EEVDF; Linux 6.12
/// and later, earlier ones ignore it). The share of time of each thread stays the same.
///
/// turn     0.1 to 100 ms
/// returns  whether the kernel accepted it
/// source   Stoica, Abdel-Wahab, "Earliest Eligible Virtual Deadline First", 1995; sched_setattr(2)
bool set_time_slice(std::chrono::nanoseconds turn);

}  // namespace collided::engine::service
