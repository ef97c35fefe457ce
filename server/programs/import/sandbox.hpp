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

/// Permanently restricts this process to reading files and writing one. Memory, processor time and the size of the
/// output are limited, capabilities are dropped, and other processes may not inspect it. Every system call except those
/// for reading files, for memory, for threads and for writing to `output` and the standard streams ends the process
/// with SIGSYS: it cannot open files for writing, open sockets, run programs, make pages both writable and executable,
/// or touch other processes. Landlock allows only the files in `readable` to be opened; a kernel without it (before
/// 5.13, or with it disabled) allows reading any file.
///
/// output    descriptor of the file to write, already open
/// readable  files, and folders with all their content; empty: none, and trying to open one ends the process
/// returns   why it could not be done, or nothing
std::string enter_sandbox(int output, const std::vector<std::string>& readable = {});

/// Address space that the process may use, in bytes: a quarter of the machine's memory, at most 8 GiB.
unsigned long long sandbox_memory_bytes();
/// Processor time that it may use, in seconds: $COLLIDED_IMPORT_SECONDS, or 30 if that is not set.
unsigned long long sandbox_seconds();

}  // namespace collided::engine
