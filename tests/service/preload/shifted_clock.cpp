#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

// The time of day as somebody may set it: the system's, and as many nanoseconds more as stand in the file named by
// COLLIDED_CLOCK_SHIFT. Steady clocks stay as they are. Who waits until a time of day (Cyclone DDS does) is woken when
// that has come, although the kernel knows nothing of the shift.
namespace {

const volatile std::int64_t* shift() {
  static const volatile std::int64_t* const place = []() -> const volatile std::int64_t* {
    static const std::int64_t kNone = 0;
    const char* path = std::getenv("COLLIDED_CLOCK_SHIFT");
    const int file = path == nullptr ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    void* memory = file < 0 ? MAP_FAILED : mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    return memory == MAP_FAILED ? &kNone : static_cast<const std::int64_t*>(memory);
  }
  ();
  return place;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const long result = syscall(SYS_clock_gettime, clock, now);
  if (result == 0 && clock == CLOCK_REALTIME) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    const std::int64_t ns = now->tv_sec * kSecond + now->tv_nsec + *shift();
    now->tv_sec = ns / kSecond;
    now->tv_nsec = ns % kSecond;
  }
  return static_cast<int>(result);
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*, const timespec*);
  static const auto wait = reinterpret_cast<Wait>(dlsym(RTLD_NEXT, "pthread_cond_timedwait"));
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns = until->tv_sec * kSecond + until->tv_nsec - *shift();
  const timespec systems{ns / kSecond, ns % kSecond};
  return wait(condition, mutex, &systems);
}

int gettimeofday(timeval* now, void*) noexcept {
  timespec exact{};
  const int result = clock_gettime(CLOCK_REALTIME, &exact);
  now->tv_sec = exact.tv_sec;
  now->tv_usec = exact.tv_nsec / 1'000;
  return result;
}

time_t time(time_t* to) noexcept {
  timespec exact{};
  clock_gettime(CLOCK_REALTIME, &exact);
  if (to != nullptr) *to = exact.tv_sec;
  return exact.tv_sec;
}

}  // extern "C"
