#pragma once

#include <memory>

#include "collided/client.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// Returns this process's DDS participant of a domain. The first call makes it; it is shared until the last owner
/// releases it. Throws dds::DdsError, and std::invalid_argument if the domain is already joined with another interface
/// or other peers or keys. Any thread.
std::shared_ptr<dds::Participant> join_domain(const ConnectOptions& options, dds::Role role = dds::Role::client);

}  // namespace collided::client
