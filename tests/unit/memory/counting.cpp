#include "tests/unit/memory/counting.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace collided::test {
namespace {

std::atomic<std::size_t> held{0};
std::atomic<std::size_t> most{0};

void hold(std::size_t bytes) {
  const std::size_t now = held.fetch_add(bytes) + bytes;
  std::size_t before = most.load();
  while (before < now && !most.compare_exchange_weak(before, now)) {}
}

void* allocate(std::size_t size, std::size_t alignment) {
  void* const memory = alignment == 0 ? std::malloc(size)
                                      : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  hold(::malloc_usable_size(memory));
  return memory;
}

void release(void* memory) {
  if (memory == nullptr) return;
  held.fetch_sub(::malloc_usable_size(memory));
  std::free(memory);
}

constexpr std::size_t kPageBytes = 4096;

/// The one mapping that is watched, since files are read one at a time, and which of its pages were given back.
struct Mapping {
  char* begin = nullptr;
  std::size_t bytes = 0;
  std::size_t held_bytes = 0;                          // from its begin
  std::atomic<std::uint8_t>* is_given_back = nullptr;  // a page each

  std::size_t end_of(std::size_t page) const { return std::min((page + 1) * kPageBytes, held_bytes); }
  /// Bytes of the pages from offset on that were not given back before.
  std::size_t give_back(std::size_t offset, std::size_t count) {
    std::size_t given = 0;
    for (std::size_t page = offset / kPageBytes; page * kPageBytes < std::min(offset + count, held_bytes); ++page) {
      if (is_given_back[page].exchange(1) == 0) given += end_of(page) - page * kPageBytes;
    }
    return given;
  }
};
Mapping mapping;

}  // namespace

std::size_t held_bytes() { return held.load(); }
std::size_t most_held_bytes() { return most.load(); }
void most_held_from_now() { most.store(held.load()); }

}  // namespace collided::test

using namespace collided::test;

void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new[](std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

// What the C library maps for itself, for its heap and for stacks, does not come by these.
extern "C" {

void* mmap(void* address, std::size_t bytes, int protection, int flags, int file, off_t offset) noexcept {
  void* const memory = reinterpret_cast<void*>(::syscall(SYS_mmap, address, bytes, protection, flags, file, offset));
  if (memory != MAP_FAILED && (flags & MAP_ANONYMOUS) != 0) {
    if (protection != PROT_NONE) hold(bytes);  // addresses alone hold nothing
    mapping.held_bytes = protection != PROT_NONE ? bytes : 0;
    mapping.begin = static_cast<char*>(memory);
    mapping.bytes = bytes;
    mapping.is_given_back = static_cast<std::atomic<std::uint8_t>*>(std::calloc(bytes / kPageBytes + 1, 1));
  }
  return memory;
}

// The reader makes what it has reserved usable from the begin on.
int mprotect(void* address, std::size_t bytes, int protection) noexcept {
  const int result = static_cast<int>(::syscall(SYS_mprotect, address, bytes, protection));
  if (result == 0 && mapping.begin != nullptr && address == mapping.begin + mapping.held_bytes &&
      (protection & PROT_WRITE) != 0) {
    hold(bytes);
    mapping.held_bytes += bytes;
  }
  return result;
}

int madvise(void* address, std::size_t bytes, int advice) noexcept {
  if (advice == MADV_DONTNEED && mapping.begin != nullptr) {
    held.fetch_sub(mapping.give_back(static_cast<std::size_t>(static_cast<char*>(address) - mapping.begin), bytes));
  }
  return static_cast<int>(::syscall(SYS_madvise, address, bytes, advice));
}

int munmap(void* address, std::size_t bytes) noexcept {
  if (address == mapping.begin) {
    held.fetch_sub(mapping.give_back(0, bytes));
    std::free(mapping.is_given_back);
    mapping.begin = nullptr;
  }
  return static_cast<int>(::syscall(SYS_munmap, address, bytes));
}

}  // extern "C"
