#include "idl/presence.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace collided::wire_contract {
namespace {

struct Address {
  sockaddr_un name{};
  socklen_t size = 0;
};

/// An abstract name begins with a zero byte and ends with the address's size.
Address address_of(int domain, std::string_view name_space, std::string_view interface) {
  const std::string text =
      "collided/" + std::to_string(domain) + "/" + std::string(interface) + "/" + std::string(name_space);
  Address address;
  address.name.sun_family = AF_UNIX;
  const std::size_t length = std::min(text.size(), sizeof(address.name.sun_path) - 1);
  std::copy_n(text.begin(), length, address.name.sun_path + 1);
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return address;
}

/// Opens a socket of that name, bound or connected by `call`; -1 if that is refused.
template <class Call>
int open_socket(int domain, std::string_view name_space, std::string_view interface, Call call) {
  const int opened = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (opened < 0) return -1;
  const Address address = address_of(domain, name_space, interface);
  if (call(opened, reinterpret_cast<const sockaddr*>(&address.name), address.size) == 0) return opened;
  close(opened);
  return -1;
}

}  // namespace

Presence::Presence(int domain, std::string_view name_space, std::string_view interface)
    : somewhere_(open_socket(domain, name_space, {}, ::bind)),
      reached_(interface.empty() ? -1 : open_socket(domain, name_space, interface, ::bind)) {
  // Rejects data from other processes, since no code reads it.
  for (const int opened : {somewhere_, reached_})
    if (opened >= 0) shutdown(opened, SHUT_RD);
}

Presence::~Presence() {
  for (const int opened : {somewhere_, reached_})
    if (opened >= 0) close(opened);
}

bool is_present_here(int domain, std::string_view name_space, std::string_view interface) {
  const int opened = open_socket(domain, name_space, interface, ::connect);
  if (opened < 0) return false;
  close(opened);
  return true;
}

}  // namespace collided::wire_contract
