#pragma once

#include <string>

namespace collided::engine {

/// False in sanitized builds, which map terabytes that they never touch and make system calls of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSandboxLimitsCalls = false;
#else
inline constexpr bool kSandboxLimitsCalls = true;
#endif

/// Takes from this process, for good, all that reading files and writing one does not need. Memory, processor time and
/// the size of the output are limited. Every system call but those for reading files, for memory, for threads and for
/// writing to `output` and the standard streams ends the process with SIGSYS: it cannot open files for writing, open
/// sockets, run programs or touch other processes.
///
/// output   descriptor of the file to write, open already
/// returns  why it could not be done, or nothing
std::string enter_sandbox(int output);

/// Bytes of address space that the process may take.
unsigned long long sandbox_memory_bytes();

}  // namespace collided::engine
