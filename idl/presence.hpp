#pragma once

#include <string_view>

namespace collided::wire_contract {

/// A mark by which programs of this machine detect, without DDS, that a server of a domain and namespace runs here: a
/// Unix socket with an abstract name, which vanishes with the process. It is visible in the same network namespace, as
/// loopback is. Any process can make such a mark, so it only influences how long to wait. Namespaces longer than a
/// socket's name (some 80 bytes) share a mark.
///
/// interface  the interface over which every client of the namespace receives the server; empty: reception is
///            uncertain, since the server has keys or its own DDS configuration
class Presence {
 public:
  /// Makes no mark if the system lacks such sockets, or another process holds the name.
  Presence(int domain, std::string_view name_space, std::string_view interface);
  ~Presence();
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;

 private:
  int somewhere_, reached_;  // -1: no mark
};

/// True if a process of this machine holds the mark.
///
/// interface  empty: any interface, also without certain reception
/// threads    any
bool is_present_here(int domain, std::string_view name_space, std::string_view interface = {});

}  // namespace collided::wire_contract
