#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "idl/dds.hpp"

// What a server that starts hears of the others of its namespace, before it says anything: DDS keeps the last word of each for
// those that join.
namespace collided::engine::service {

/// uses_keys  the others must come through the handshake first
/// least_ns   how long it is listened at least while nobody is heard
/// returns    the process of a server that speaks for the namespace; nothing: there is none
std::optional<long> heard_primary(const dds::Participant& participant, const std::string& name_space, bool uses_keys,
                                  std::int64_t least_ns = 0);

/// The greatest epoch of the servers of the namespace, those that stand by among them; 0: there is none.
std::uint64_t greatest_epoch(const dds::Participant& participant, const std::string& name_space, bool uses_keys);

}  // namespace collided::engine::service
