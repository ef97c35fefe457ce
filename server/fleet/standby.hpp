#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/service/events/dds_event_writer.hpp"
#include "server/fleet/change_follower.hpp"
#include "server/fleet/membership.hpp"
#include "server/fleet/primary_pulse.hpp"
#include "server/fleet/world_comparison.hpp"

namespace collided::engine::service {

/// The part of a server that stands by: follows the primary's commands, compares worlds, and has publishers say all again
/// where the two differ, since what moved before this server was there and rests since is known to nobody else. Takes the
/// primary's place where that falls silent, if it holds all that the primary had.
///
/// threads  hear() and note_own() are for the Membership's thread, the rest is for any
class Standby {
 public:
  /// The server whose place is taken.
  struct Predecessor {
    std::uint64_t server = 0;
    std::uint64_t epoch = 0;
    SpokenBefore spoken;
    bool is_same = true;  // this server held the same world when that was compared last
  };
  struct PlaceRules {
    std::int64_t silent_after_ns = 0;  // when the primary is given up; 0: never
    bool is_replica = false;           // never takes the primary's place
  };
  struct RaisedEpoch {
    std::uint64_t value = 0;
    std::string problem;  // why it was not raised; empty: it was
  };
  struct PlaceCollaborators {
    /// Makes this server the primary in the place of that one; false: not yet.
    std::function<bool(const Predecessor& of, const std::string& why)> take_over;
    /// Whether an authority has given this server the place: then it takes over, whatever the primary publishes.
    std::function<bool()> has_place;
    /// Gives this server another epoch, at least that one, in all that it publishes from then on. Waits until that is written down.
    std::function<RaisedEpoch(std::uint64_t least)> raise_epoch;
    /// Called once it is clear that this server has to be started again; more than once maybe. Where it has the place, nobody
    /// else can take it before.
    std::function<void()> cannot_follow;
  };
  Standby(const dds::Participant& participant, const Identity& identity, const ChangeFollower::Collaborators& with,
          const PlaceRules& rules, PlaceCollaborators place);

  /// Called with each instant at which the worlds were compared, and whether this server holds what the primary does. To be
  /// set before the first call of hear().
  void on_compared(std::function<void(std::int64_t instant_ns, bool is_same)> compared) {
    compared_ = std::move(compared);
  }
  /// No place is taken from now on, and nothing carried out; hear() and note_own() are not to be called any more.
  void leave();
  void hear(const OtherMember& other);
  void note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state);
  /// Takes the primary's place, if this server holds all that it had. False: it does not.
  bool take_place(const std::string& why);
  /// This server's epoch. It is raised where that of the primary is not below it, or another one that stands by has the same.
  std::uint64_t epoch() const { return epoch_.load(); }
  /// How many of the primary's changes it has carried out.
  std::uint64_t carried_out() const { return follower_.carried_out(); }
  /// What it wants of the primary.
  Following following() const;
  /// recovering until it has what the primary has.
  wire_contract::ServerState state() const;
  /// What it lacks, one sentence a line.
  std::string alarm() const;

 private:
  /// Another server that stands by, and may come before this one.
  struct Rival {
    std::uint64_t epoch = 0;
    bool is_ready = false;
    std::int64_t heard_ns = 0;  // steady clock
  };
  void hear_rival(const OtherMember& rival);
  void hear_another_primary(const OtherMember& other);
  void note_primary(const OtherMember& primary);
  bool turn_to(const OtherMember& heir);
  bool shares_epoch() const;
  void raise_epoch();
  void judge();
  void refuse_for_good(std::string sentence);
  bool succeed(std::int64_t silent_ns);
  bool may_take_place() const;
  std::string what_is_missing() const;
  int ready_before_this_one() const;

  const ChangeFollower::Collaborators with_;
  const std::uint64_t self_;
  std::atomic<std::uint64_t> epoch_;
  const PlaceRules rules_;
  const PlaceCollaborators place_;
  std::function<void(std::int64_t, bool)> compared_;  // empty: nobody wants to know
  WorldComparison comparison_;
  std::uint64_t judged_ = 0;  // compared instants that were looked at
  std::atomic<std::uint64_t> again_{1};
  std::atomic<bool> is_same_{false};           // the worlds were the same at the newest instant that was compared
  std::atomic<std::int64_t> same_from_ns_{0};  // and at all from this one on, world time
  std::atomic<bool> is_outranked_{false};      // the primary's epoch is not below this server's
  std::atomic<std::int64_t> turned_ns_{0};     // when it turned to another primary, steady clock
  mutable std::mutex mutex_;                   // for these nine
  std::string first_to_differ_;                // when the worlds were found to differ last; empty: never
  std::string difference_;                     // empty: there is none that lasts
  std::string no_heir_;        // why it cannot take the primary's place before it is started again; empty: it can
  std::string epoch_problem_;  // why its epoch is not raised; empty: it need not be
  std::uint64_t primary_server_ = 0;  // this and its name: as it was heard last
  std::string primary_name_;
  std::uint64_t primary_epoch_ = 0;         // this and the next: or those of an heir, before it is followed
  std::int64_t primary_heard_ns_ = 0;       // steady clock
  std::map<std::uint64_t, Rival> rivals_;   // by server
  std::atomic<bool> is_left_alone_{false};  // the primary is silent, and this server is not ready
  std::mutex taking_mutex_;                 // held while the place is taken; for the next two
  bool has_place_ = false;
  bool has_left_ = false;
  ChangeFollower follower_;
  std::optional<PrimaryPulse> pulse_;
};

}  // namespace collided::engine::service
