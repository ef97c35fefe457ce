#pragma once

#include <string>

namespace collided::engine::service {

/// Tells the process that supervises us (systemd) a state such as "READY=1" over the datagram socket that NOTIFY_SOCKET
/// names; does nothing where it names none.
///
/// source  sd_notify(3), "Standalone Implementations"
void notify_supervisor(const std::string& state);

}  // namespace collided::engine::service
