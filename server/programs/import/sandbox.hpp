#pragma once

#include <string>
#include <vector>

namespace collided::engine {

/// False in sanitized builds, which map terabytes that they never touch and make system calls of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSandboxLimitsCalls = false;
#else
inline constexpr bool kSandboxLimitsCalls = true;
#endif

/// Takes from this process, for good, all that reading files and writing one does not need. Memory, processor time and
/// the size of the output are limited, capabilities are dropped, and other processes may not look into it. Every system
/// call but those for reading files, for memory, for threads and for writing to `output` and the standard streams ends
/// the process with SIGSYS: it cannot open files for writing, open sockets, run programs, make pages both writable and
/// executable, or touch other processes. No file can be opened but those in `readable`, by Landlock; a kernel without it
/// (before 5.13, or where it is switched off) limits what can be opened to reading.
///
/// output    descriptor of the file to write, open already
/// readable  files, and folders with all that is in them; empty: none, and trying to open one ends the process
/// returns   why it could not be done, or nothing
std::string enter_sandbox(int output, const std::vector<std::string>& readable = {});

/// Bytes of address space that the process may take: a quarter of the machine's memory, at most 8 GiB.
unsigned long long sandbox_memory_bytes();
/// Seconds of processor time that it may take: $COLLIDED_IMPORT_SECONDS, 30 where that is not set.
unsigned long long sandbox_seconds();

}  // namespace collided::engine
