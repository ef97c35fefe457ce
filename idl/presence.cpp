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

/// An abstract name begins with a zero byte and has no end but the address's size.
Address address_of(int domain, std::string_view name_space) {
  const std::string text = "collided/" + std::to_string(domain) + "/" + std::string(name_space);
  Address address;
  address.name.sun_family = AF_UNIX;
  const std::size_t length = std::min(text.size(), sizeof(address.name.sun_path) - 1);
  std::copy_n(text.begin(), length, address.name.sun_path + 1);
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return address;
}

/// A socket of that name, bound or connected by `call`; -1 where that is refused.
template <class Call>
int open_socket(int domain, std::string_view name_space, Call call) {
  const int opened = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (opened < 0) return -1;
  const Address address = address_of(domain, name_space);
  if (call(opened, reinterpret_cast<const sockaddr*>(&address.name), address.size) == 0) return opened;
  close(opened);
  return -1;
}

}  // namespace

Presence::Presence(int domain, std::string_view name_space) : socket_(open_socket(domain, name_space, ::bind)) {
  // Nobody reads what others may send.
  if (socket_ >= 0) shutdown(socket_, SHUT_RD);
}

Presence::~Presence() {
  if (socket_ >= 0) close(socket_);
}

bool is_present_here(int domain, std::string_view name_space) {
  const int opened = open_socket(domain, name_space, ::connect);
  if (opened < 0) return false;
  close(opened);
  return true;
}

}  // namespace collided::wire_contract
