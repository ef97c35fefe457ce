#pragma once

#include <string>

namespace collided::engine {

/// False in sanitized builds: they map terabytes that they never touch, and make system calls of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSandboxLimitsCalls = false;
#else
inline constexpr bool kSandboxLimitsCalls = true;
#endif

/// Takes away from this process, for good, what reading a file and writing another does not need: memory, processor time
/// and size of the output are limited, and every system call but those for reading files, for memory, for threads and for
/// writing to `output` and the standard streams ends the process with SIGSYS. Files cannot be opened for writing, nor sockets,
/// nor can programs be run or other processes be touched.
///
/// output   descriptor of the file to write, open already
/// returns  why it could not be done, or nothing
std::string enter_sandbox(int output);

/// Bytes of address space that the process may take.
unsigned long long sandbox_memory_bytes();

}  // namespace collided::engine
