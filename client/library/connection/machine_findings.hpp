#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collided/diagnosis.hpp"

/// Checks of this machine that need no DDS.
namespace collided::client {

/// Whether the network interface exists and is up. Nothing for "auto".
std::optional<Finding> interface_finding(const std::string& interface);

/// The largest receive buffer that a program may request. Nothing where the system does not tell.
std::optional<Finding> buffer_finding();

/// How many of the domain's places for servers on this machine are taken.
Finding places_finding(int domain);

/// Datagrams dropped by this machine since its start since a receiver's buffer was full. Nothing where it does not
/// tell.
std::optional<std::uint64_t> dropped_datagrams();

/// The servers among this machine's processes, as far as they are visible: "pid 4711: collided --domain 3".
std::vector<std::string> servers_here();

}  // namespace collided::client
