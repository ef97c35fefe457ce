#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::view {

/// Who may talk to the viewer. A page of another site that a browser shows must not: it reaches local ports as well, under
/// a name of its own (DNS rebinding) or from an origin of its own.
struct RequestRules {
  std::vector<std::string> hosts{};    // names under which it may be asked, beside the address of the socket itself
  std::vector<std::string> origins{};  // of other pages that may connect, "https://app.foxglove.dev"
};

/// Whether a Host header names this machine: the very address that the connection came to, localhost on a loopback
/// address, or one of the rules' names. The port is free, since it may have been forwarded.
bool may_be_called(std::string_view host, std::string_view own_address, bool is_loopback, const RequestRules& rules);

/// Whether a page may connect: one that came from here (its origin is the asked host), one of the rules', or no page at all
/// (programs send no origin). To be asked after may_be_called.
bool may_connect(std::string_view origin, std::string_view host, const RequestRules& rules);

}  // namespace collided::view
