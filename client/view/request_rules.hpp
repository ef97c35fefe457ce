#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace collided::view {

/// Which requests the viewer accepts. A page of another site, shown in the user's browser, can reach local ports too,
/// under its own host name (DNS rebinding) or from its own origin. It must be refused.
struct RequestRules {
  std::vector<std::string> hosts{};    // accepted host names, besides the address of the socket itself
  std::vector<std::string> origins{};  // of other pages that may connect, such as "https://app.foxglove.dev"
  std::string token{};                 // a request must contain it; empty: none is needed
};

/// An unguessable token: 128 random bits in hexadecimal. Throws std::runtime_error if the system has none.
std::string new_token();

/// Whether a Host header is accepted: it must be the address that the connection was made to, localhost for a loopback
/// address, or one of the rules' names. Any port is accepted, since ports may be forwarded.
bool may_be_called(std::string_view host, std::string_view own_address, bool is_loopback, const RequestRules& rules);

/// Whether a page may connect: its origin is the requested host or one of the rules', or there is none, as for programs
/// that are not browsers. Check may_be_called first.
bool may_connect(std::string_view origin, std::string_view host, const RequestRules& rules);

/// How a request proves its access.
enum class Admission { none, by_cookie, by_query };

/// Whether the request contains the rules' token: as `token` in the query of its target, or in a cookie of that name.
/// All are admitted (by_cookie) if the rules have none. The time it takes does not depend on the token.
///
/// cookies  the Cookie header
Admission admission_of(std::string_view target, std::string_view cookies, std::string_view cookie_name,
                       const RequestRules& rules);

/// The target without `token` in its query.
std::string without_token(std::string_view target);

}  // namespace collided::view
