#pragma once

#include <string>

namespace collided::dds {

/// The element <Security> of Cyclone's configuration; empty where there are no keys.
///
/// keys       folder of keys
/// handshake  library that stands before Cyclone's own for authentication; empty: the shared library that this function
///            is in, if it has the functions (the client library), else none
/// throws     DdsError where a path has a character that the configuration cannot hold
std::string security_config(const std::string& keys, const std::string& handshake);

/// Cyclone's own libraries: of authentication and of access control.
std::string authentication_library();
std::string access_control_library();

/// The functions of a library that stands before it, which the configuration names.
inline constexpr const char* kHandshakeBegin = "collided_handshake_begin";
inline constexpr const char* kHandshakeEnd = "collided_handshake_end";

}  // namespace collided::dds
