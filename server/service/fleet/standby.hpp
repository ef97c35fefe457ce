#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "server/service/events/dds_event_writer.hpp"
#include "server/service/fleet/change_follower.hpp"
#include "server/service/fleet/membership.hpp"
#include "server/service/fleet/world_comparison.hpp"

namespace collided::engine::service {

/// The part of a server that stands by: follows the primary's commands, compares worlds, and has publishers say all again
/// where the two differ, since what moved before this server was there and rests since is known to nobody else.
///
/// threads  hear() and note_own() are for the Membership's thread, the rest is for any
class Standby {
 public:
  Standby(const dds::Participant& participant, const Identity& identity, const ChangeFollower::Collaborators& with);

  void hear(const OtherMember& other);
  void note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state);
  /// What it wants of the primary.
  Following following() const;
  /// recovering until it has what the primary has.
  wire_contract::ServerState state() const;
  /// What it lacks, one sentence a line.
  std::string alarm() const;

 private:
  void judge();

  const ChangeFollower::Collaborators with_;
  WorldComparison comparison_;
  std::uint64_t judged_ = 0;  // compared instants that were looked at
  std::atomic<std::uint64_t> again_{1};
  std::atomic<bool> is_same_{false};  // the worlds were the same at the newest instant that was compared
  mutable std::mutex mutex_;          // for these two
  std::string difference_;            // empty: there is none that lasts
  std::string other_primary_;
  ChangeFollower follower_;
};

}  // namespace collided::engine::service
