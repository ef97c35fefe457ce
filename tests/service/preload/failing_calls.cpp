#include "tests/service/preload/failing_calls.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

// The names below take the place of the library's own. Those of memory must not look anything up, which takes memory.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace collided::testing_support {
namespace {

constinit std::atomic<Failing> failing{Failing::none};
constinit std::atomic<long> calls_left{0};
constinit std::atomic<bool> has_failed{false};

bool fails(Failing call) {
  if (failing.load(std::memory_order_relaxed) != call || calls_left.fetch_sub(1) != 1) return false;
  has_failed.store(true);
  return true;
}

/// Of a preloaded library: before main.
[[gnu::constructor]] void read_environment() {
  const char* wish = std::getenv("COLLIDED_FAIL");
  char name[16] = {};
  long n = 0;
  if (wish == nullptr || std::sscanf(wish, "%15s %ld", name, &n) != 2) return;
  for (int call = 0; call < static_cast<int>(std::size(kFailingNames)); ++call) {
    if (std::strcmp(name, kFailingNames[call]) == 0) fail_call(static_cast<Failing>(call), n);
  }
}

}  // namespace

void fail_call(Failing call, long n) {
  has_failed.store(false);
  calls_left.store(n);
  failing.store(call);
}

bool stop_failing() {
  failing.store(Failing::none);
  return has_failed.load();
}

}  // namespace collided::testing_support

using collided::testing_support::Failing;
using collided::testing_support::fails;

extern "C" {

void* malloc(std::size_t size) { return fails(Failing::malloc) ? (errno = ENOMEM, nullptr) : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) {
  return fails(Failing::malloc) ? (errno = ENOMEM, nullptr) : __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  return fails(Failing::malloc) ? (errno = ENOMEM, nullptr) : __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails(Failing::malloc) ? (errno = ENOMEM, nullptr) : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (fails(Failing::malloc)) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  if (file <= 2 || !fails(Failing::write)) return syscall(SYS_write, file, bytes, count);
  static_cast<void>(syscall(SYS_write, file, bytes, count / 2));
  errno = ENOSPC;
  return -1;
}

int fsync(int file) { return fails(Failing::fsync) ? (errno = EIO, -1) : static_cast<int>(syscall(SYS_fsync, file)); }

int rename(const char* from, const char* to) noexcept {
  return fails(Failing::rename) ? (errno = ENOSPC, -1)
                                : static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

}  // extern "C"
