#pragma once

#include <cstdint>

namespace collided::client {

/// Whether a process of this number and program runs on this machine, or waits for a processor or a disk: one that was
/// killed, stopped or is traced does not. False also where it cannot be seen, in another container for example.
///
/// program  its name, as in /proc/PID/comm
bool runs_here(std::uint32_t pid, const char* program);

/// Whether this machine has three times as many threads that could run as processors, or more. Of this moment.
bool is_machine_crowded();

}  // namespace collided::client
