#pragma once

#include <string_view>

namespace collided::wire_contract {

/// A mark by which the programs of this machine see that a server of a domain and namespace runs here, without DDS: a Unix
/// socket of an abstract name, which goes with the process. It reaches as far as loopback does (one network namespace).
/// Any process can make such a mark, so it says how long waiting is worth while and nothing else. Names that are longer
/// than a socket's may be (some 80 bytes of the namespace) share one.
///
/// interface  over which everybody of the namespace hears the server; empty: nobody can be sure to, since it has keys or a
///            configuration of DDS of its own
class Presence {
 public:
  /// Without a mark where the system has no such sockets, or another process holds the name.
  Presence(int domain, std::string_view name_space, std::string_view interface);
  ~Presence();
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;

 private:
  int somewhere_, reached_;  // -1: no mark
};

/// Whether a process of this machine holds the mark.
///
/// interface  empty: of whichever, and whether it can be heard or not
/// threads    any
bool is_present_here(int domain, std::string_view name_space, std::string_view interface = {});

}  // namespace collided::wire_contract
