#pragma once

#include <string_view>

namespace collided::wire_contract {

/// A mark by which the programs of this machine see that a server of a domain and namespace runs here, without DDS: a Unix
/// socket of an abstract name, which goes with the process. It reaches as far as loopback does (one network namespace).
/// Any process can make such a mark, so it says how long waiting is worth while and nothing else. Names that are longer
/// than a socket's may be (some 90 bytes of the namespace) share one.
class Presence {
 public:
  /// Without a mark where the system has no such sockets, or another process holds the name.
  Presence(int domain, std::string_view name_space);
  ~Presence();
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;

 private:
  int socket_;
};

/// Whether a process of this machine holds the mark.
///
/// threads  any
bool is_present_here(int domain, std::string_view name_space);

}  // namespace collided::wire_contract
