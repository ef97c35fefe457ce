#pragma once

#include <memory>

#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// This process's participant of a domain, made by the first who asks and shared until the last lets go. Throws
/// dds::DdsError, and std::invalid_argument when the domain was joined with another interface or other peers before.
std::shared_ptr<dds::Participant> join_domain(const ConnectOptions& options, dds::Role role = dds::Role::client);

}  // namespace collided::client
