#include "server/service/runtime/out_of_memory.hpp"

#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace collided::engine::service {

void end_out_of_memory(const char* where) noexcept {
  const auto piece = [](const char* text) { return iovec{const_cast<char*>(text), std::strlen(text)}; };
  const std::array<iovec, 3> line{
      piece("error: no memory left for "), piece(where),
      piece("; ending, since half a change is none. Started again it recovers as after a crash\n")};
  // If even this cannot be written there is nothing left to do about it; the sum keeps the compiler from warning.
  static_cast<void>(writev(STDERR_FILENO, line.data(), static_cast<int>(line.size())) + 1);
  _exit(kOutOfMemoryExit);
}

}  // namespace collided::engine::service
