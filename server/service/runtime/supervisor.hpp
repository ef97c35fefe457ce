#pragma once

#include <string>

namespace collided::engine::service {

/// Sends a state such as "READY=1" to the supervising process (systemd), over the datagram socket that NOTIFY_SOCKET
/// names. Does nothing if that is not set or cannot be reached.
///
/// source  sd_notify(3), "Standalone Implementations"
void notify_supervisor(const std::string& state);

}  // namespace collided::engine::service
