#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <string>

namespace collided::testing_support {

/// A DDS domain from 101 to 190 that no other test process uses while this one lives; tests/in_own_domain.py claims those above.
inline int own_domain() {
  constexpr int kFirst = 101;
  constexpr int kCount = 90;
  static const int domain = [] {
    for (int i = 0; i < kCount; ++i) {
      const int candidate = kFirst + static_cast<int>((getpid() + i) % kCount);
      // A socket without a file: held until this process ends, and nothing stays of it.
      const std::string name = "collided_test_domain_" + std::to_string(candidate);
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
      const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
      const int lock = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (lock >= 0 && bind(lock, reinterpret_cast<const sockaddr*>(&address), length) == 0) return candidate;
      if (lock >= 0) close(lock);
    }
    return kFirst;
  }();
  return domain;
}

}  // namespace collided::testing_support
