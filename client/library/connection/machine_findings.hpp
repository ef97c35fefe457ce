#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collided/diagnosis.hpp"

/// Checks of this machine that need no DDS.
namespace collided::client {

/// Checks that the network interface exists and is up. Nothing for "auto".
std::optional<Finding> interface_finding(const std::string& interface);

/// Checks the largest receive buffer that a program may request. Nothing if unknown.
std::optional<Finding> buffer_finding();

/// Counts the domain's occupied places for servers on this machine.
Finding places_finding(int domain);

/// Number of datagrams that this machine has dropped since its start because a receive buffer was full. Nothing if
/// unknown.
std::optional<std::uint64_t> dropped_datagrams();

/// The visible server processes of this machine: "pid 4711: collided --domain 3".
std::vector<std::string> servers_here();

}  // namespace collided::client
