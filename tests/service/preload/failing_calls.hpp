#pragma once

namespace collided::testing_support {

/// Calls of the C library that can be made to fail, in this process where failing_calls.cpp is linked, in another one
/// where it is preloaded with COLLIDED_FAIL="NAME N".
enum class Failing { none, write, fsync, rename, malloc };
inline constexpr const char* kFailingNames[] = {"none", "write", "fsync", "rename", "malloc"};

/// The n-th call from now on (from 1) fails once: a write after half of its bytes, memory with none.
void fail_call(Failing call, long n);
/// No more; whether one has failed.
bool stop_failing();

}  // namespace collided::testing_support
