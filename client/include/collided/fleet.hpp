#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <collided/client.hpp>
#include <collided/codes.hpp>
#include <collided/diagnosis.hpp>

/// Which servers of a namespace are there, and do they fit together?
#pragma GCC visibility push(default)

namespace collided {

using FleetRole = codes::MemberRole;
using codes::name_of;

/// A server of a namespace, as it says itself.
struct FleetMember {
  std::uint64_t server = 0;  // random, one per start
  std::uint64_t epoch = 0;   // grows with each start, and where a standby follows another primary
  FleetRole role = FleetRole::primary;
  std::string state;  // starting, recovering, ready or stopping, as in ServerStatus
  std::string name;   // collided --member, or the machine's name and the process number
  std::string host;   // the machine's name
  std::uint32_t pid = 0;
  std::string version_text;             // of the program
  std::chrono::nanoseconds started{0};  // since 1970, its machine's clock
  std::chrono::nanoseconds up{0};       // since then
  std::uint64_t version = 0;            // of its world; grows with each change
  std::chrono::nanoseconds lag{0};      // how far its settled world is behind its clock
  std::uint64_t scene_fingerprint = 0;  // of its scenes, whatever their order; 0: none
  /// Of the world as it was at one instant, equal where two servers hold the same world; both 0 where nobody is there to
  /// be compared with.
  std::uint64_t world_hash = 0;
  std::chrono::nanoseconds hash_time{0};    // world time
  std::chrono::nanoseconds clock_ahead{0};  // of this machine's clock, as far as that can be told; negative: behind
  std::string alarm;                        // what is wrong with it, one sentence a line; empty: nothing
};

/// The servers of a namespace, by name, and what does not fit together.
struct Fleet {
  std::vector<FleetMember> members;
  /// `about` is one of: primaries, versions, scenes, worlds, clocks, alarm.
  std::vector<Finding> findings;
};

/// Listens for the servers of a namespace. Nothing is asked of them, so one that answers nobody is heard too.
///
/// returns  no_server where none is heard
/// cost     1.5 s
/// threads  any
Result<Fleet> fleet(const ConnectOptions& options);

/// What does not fit together among these: two primaries or none, different versions, scenes or worlds, clocks that are
/// apart, and what a member says is wrong with it.
/// threads  pure
std::vector<Finding> fleet_findings(const std::vector<FleetMember>& members);

}  // namespace collided

#pragma GCC visibility pop
