#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>
#include <collided/codes.hpp>
#include <collided/diagnosis.hpp>

/// The servers of a namespace, and whether they fit together.
#pragma GCC visibility push(default)

namespace collided {

using FleetRole = codes::MemberRole;
using codes::name_of;

/// A server of a namespace, as it describes itself.
struct FleetMember {
  std::uint64_t server = 0;  // random, drawn at each start
  std::uint64_t epoch = 0;   // grows with each start, and when a standby follows another primary
  FleetRole role = FleetRole::primary;
  std::string state;  // starting, recovering, ready or stopping, as in ServerStatus
  std::string name;   // collided --member, or the machine's name and the process number
  std::string host;   // the machine's name
  std::uint32_t pid = 0;
  std::string version_text;             // of the program
  std::chrono::nanoseconds started{0};  // since 1970, its machine's clock
  std::chrono::nanoseconds up{0};       // since then
  std::uint64_t version = 0;            // of its world; grows with each change
  std::chrono::nanoseconds lag{0};      // its clock minus the time of its settled world
  std::uint64_t scene_fingerprint = 0;  // of its scenes, in any order; 0: none
  /// Hash of the world at hash_time, equal for two servers that hold the same world. Both 0 if there is no other server
  /// to compare with.
  std::uint64_t world_hash = 0;
  std::chrono::nanoseconds hash_time{0};    // world time
  std::chrono::nanoseconds clock_ahead{0};  // its clock minus this machine's, an estimate
  std::string alarm;                        // its faults, one sentence per line; empty: none
};

/// The servers of a namespace, by name, and any inconsistencies between them.
struct Fleet {
  std::vector<FleetMember> members;
  /// `about` is one of: primaries, versions, scenes, worlds, clocks, alarm.
  std::vector<Finding> findings;
};

/// Collects the records that the servers of a namespace publish. It sends no request, so it also finds a server that
/// answers no questions.
///
/// returns  error no_server if there is none
/// cost     1.5 s
/// threads  any
Result<Fleet> fleet(const ConnectOptions& options);

/// Returns the inconsistencies between members: two primaries or none, different versions, scenes or worlds, clocks
/// that differ, and faults that a member reports.
/// threads  pure
std::vector<Finding> fleet_findings(const std::vector<FleetMember>& members);

}  // namespace collided

#pragma GCC visibility pop
