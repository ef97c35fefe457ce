#pragma once

namespace collided::engine::service {

/// Exit code of a process that has run out of memory, so that a supervisor restarts it (sysexits' EX_OSERR).
inline constexpr int kOutOfMemoryExit = 71;

/// Ends the process with one line on stderr, without another allocation. Call this if memory ran out while the world
/// was being changed, or with a sample in hand that does not come again: the state is then incomplete, and later
/// answers would be unreliable. The next process recovers as after a crash: undecided until all publishers are back,
/// never a miss.
///
/// where    what the memory was for, such as "the world's thread"
/// threads  any
[[noreturn]] void end_out_of_memory(const char* where) noexcept;

/// Makes abort() report on stderr that the process ends, and a possible reason: DDS aborts silently if it gets no
/// memory. The process still ends by the signal. If memory ran out within a destructor, which no caller can catch, the
/// process ends as by end_out_of_memory().
void report_aborts() noexcept;

}  // namespace collided::engine::service
