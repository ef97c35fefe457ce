#pragma once

#include <cstdint>

namespace collided::client {

/// True if a process with this number and program runs on this machine, or waits for a processor or a disk. False if it
/// was killed or stopped or is traced, or is invisible, for example in another container.
///
/// program  its name, as in /proc/PID/comm
bool runs_here(std::uint32_t pid, const char* program);

/// True if this machine now has at least three times as many runnable threads as processors.
bool is_machine_crowded();

}  // namespace collided::client
