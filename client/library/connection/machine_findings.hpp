#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collided/diagnosis.hpp"

/// What this machine itself tells, without DDS.
namespace collided::client {

/// Whether the interface is there and up. Nothing for "auto" and where DDS has a configuration of its own.
std::optional<Finding> interface_finding(const std::string& interface);

/// The largest receive buffer that a program may ask for. Nothing where the system does not say.
std::optional<Finding> buffer_finding();

/// How many of the domain's places for servers on this machine are taken.
Finding places_finding(int domain);

/// Datagrams that this machine dropped since it started because a receiver's buffer was full.
std::optional<std::uint64_t> dropped_datagrams();

/// "pid 4711: collided --domain 3": the servers on this machine that may be looked at.
std::vector<std::string> servers_here();

}  // namespace collided::client
