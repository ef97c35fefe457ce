#pragma once

#include <cstddef>

/// Bytes that this program holds, of `new` and of memory mapped without a file: counting.cpp stands in for operator new
/// and delete, mmap, munmap and madvise. Unlike the resident set it is the same in every run.
namespace collided::test {

/// Now.
std::size_t held_bytes();
/// The most since most_held_from_now().
std::size_t most_held_bytes();
void most_held_from_now();

}  // namespace collided::test
