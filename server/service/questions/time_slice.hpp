#pragma once

#include <chrono>

namespace collided::engine::service {

/// Of threads that somebody waits for: reading, the world's steps.
inline constexpr std::chrono::nanoseconds kShortSlice = std::chrono::microseconds(100);
/// Of threads that work off batches: whoever waits for less than that goes first.
inline constexpr std::chrono::nanoseconds kLongSlice = std::chrono::milliseconds(20);

/// Asks the kernel to let this thread, and those that it starts from then on, run in turns of this length where processors
/// are short: who wants shorter turns than the one that runs need not wait for its end (EEVDF; Linux 6.12 and later,
/// earlier ones pay no heed). Takes nothing from anybody: the share of time stays the same.
///
/// turn     0.1 to 100 ms
/// returns  whether the kernel took it
/// source   Stoica, Abdel-Wahab, "Earliest Eligible Virtual Deadline First", 1995; sched_setattr(2)
bool set_time_slice(std::chrono::nanoseconds turn);

}  // namespace collided::engine::service
