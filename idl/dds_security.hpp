#pragma once

#include <string>

namespace collided::dds {

/// The element <Security> of Cyclone's configuration; empty if there are no keys.
///
/// keys       folder of keys
/// handshake  library that wraps Cyclone's authentication plugin; empty: the shared library that contains this
///            function, if it also has the wrapper (the client library), else none
/// throws     DdsError if a path has a character that is invalid in the configuration
std::string security_config(const std::string& keys, const std::string& handshake);

/// Cyclone's own plugins for authentication and access control.
std::string authentication_library();
std::string access_control_library();

/// The functions of a wrapping library, as named in the configuration.
inline constexpr const char* kHandshakeBegin = "collided_handshake_begin";
inline constexpr const char* kHandshakeEnd = "collided_handshake_end";

}  // namespace collided::dds
