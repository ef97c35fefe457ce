#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::view {

/// Which requests the viewer accepts. A page of another site, shown in the user's browser, can reach local ports too,
/// under its own host name (DNS rebinding) or from its own origin. It must be refused.
struct RequestRules {
  std::vector<std::string> hosts{};    // host names that are accepted, besides the address of the socket itself
  std::vector<std::string> origins{};  // of other pages that may connect, such as "https://app.foxglove.dev"
};

/// Whether a Host header is accepted: it must be the address that the connection was made to, localhost for a loopback
/// address, or one of the rules' names. Any port is accepted, since ports may be forwarded.
bool may_be_called(std::string_view host, std::string_view own_address, bool is_loopback, const RequestRules& rules);

/// Whether a page may connect: its origin is the requested host or one of the rules', or there is none, as for programs
/// that are not browsers. Check may_be_called first.
bool may_connect(std::string_view origin, std::string_view host, const RequestRules& rules);

}  // namespace collided::view
