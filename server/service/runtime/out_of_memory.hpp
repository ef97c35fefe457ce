#pragma once

namespace collided::engine::service {

/// What a process ends with that has run out of memory: a supervisor restarts it (sysexits' EX_OSERR).
inline constexpr int kOutOfMemoryExit = 71;

/// Where memory ran out while the state of the world was being changed, or with a sample in hand that will not come again,
/// what is held is not whole, and nothing said from then on could be relied on. So the process says so in a line and ends,
/// without another allocation; the next one recovers as after a crash: undecided until everybody is back, never a miss.
///
/// where    "the world's thread"
/// threads  any
[[noreturn]] void end_out_of_memory(const char* where) noexcept;

}  // namespace collided::engine::service
