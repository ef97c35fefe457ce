// Preloaded into a server: a machine whose clock of the day is off by SHIFT_CLOCK_SECONDS. The steady clock stays; who waits
// until a time of day waits no longer than without.
#include <dlfcn.h>
#include <pthread.h>

#include <cstdlib>
#include <ctime>

namespace {

time_t shift() {
  static const char* const text = std::getenv("SHIFT_CLOCK_SECONDS");
  return text != nullptr ? std::atol(text) : 0;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, struct timespec* time) noexcept {
  using Real = int (*)(clockid_t, struct timespec*);
  static const auto real = reinterpret_cast<Real>(dlsym(RTLD_NEXT, "clock_gettime"));
  const int code = real(clock, time);
  if (code == 0 && clock == CLOCK_REALTIME) time->tv_sec += shift();
  return code;
}

extern "C" int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const struct timespec* until) {
  using Real = int (*)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*);
  // The plain name may be that of an older layout of conditions.
  static const auto real = reinterpret_cast<Real>(dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2"));
  struct timespec real_until = *until;
  real_until.tv_sec -= shift();
  return real(condition, mutex, &real_until);
}
