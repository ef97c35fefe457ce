#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>

// A disk on which every fsync takes COLLIDED_FSYNC_MS milliseconds: what must wait for it waits long enough to be looked at.
extern "C" int fsync(int file) {
  const char* text = std::getenv("COLLIDED_FSYNC_MS");
  const long ms = text == nullptr ? 0 : std::atol(text);
  timespec left{ms / 1'000, ms % 1'000 * 1'000'000};
  while (nanosleep(&left, &left) != 0) {}
  return static_cast<int>(syscall(SYS_fsync, file));
}
