#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/service/events/event_writer.hpp"
#include "server/fleet/change_feed.hpp"
#include "server/fleet/handover_words.hpp"
#include "server/fleet/membership.hpp"

namespace collided::engine::service {

/// Which part this server has in its namespace, and how that changes: a standby takes the place of a primary that has fallen
/// silent or hands over, and a primary gives way to a standby that has taken its place.
///
/// threads  hear() and forget() for one, the rest for any
class Succession {
 public:
  struct Collaborators {
    /// Has the world's thread do it soon, however many commands wait. The four that follow are called there.
    std::function<void(std::function<void()>)> on_world_thread;
    std::function<void(const SpokenBefore&)> speak;  // see WorldLoop
    std::function<void()> fall_silent;
    std::function<PublisherProgress()> say_last_words;              // and falls silent
    std::function<bool(const PublisherProgress&)> has_come_as_far;  // with the publishers that live
    std::function<void()> lend_place;  // where an authority says who is the primary: for the one that is to take it
    std::function<bool()> take_place_back;        // from there; false: another one has it
    std::function<void()> answer_held_questions;  // those that came since it began to hand over
    std::atomic<bool>& takes_questions;
    std::uint64_t self = 0;                // number of this server
    std::function<std::uint64_t()> epoch;  // of this server
    bool joins = false;                    // it is started again when it ends, and takes the part then that is left
    std::function<void(const std::string&)> notice;
    std::function<void()> became_primary;
    std::function<void()> end;  // has the process end; returns at once
  };
  Succession(Collaborators with, wire_contract::MemberRole role) : with_(std::move(with)), role_(role) {}

  wire_contract::MemberRole role() const { return role_.load(); }
  /// The server whose place this one has taken; 0: none.
  std::uint64_t predecessor() const { return predecessor_.load(); }
  /// Another server of the namespace has said what it is. Where it has taken this one's place, this one falls silent and
  /// has its process end. So does one of two that have joined at once, that which began later.
  void hear(const OtherMember& other);
  /// Another server of the namespace has left.
  void forget(std::uint64_t server);
  /// The authority has given this one's place to another server; does the same.
  void lose_place(const std::string& why);
  /// This server stands by and cannot follow the primary any more. One that joins has its process end.
  void cannot_follow();

  /// Makes this server the primary in the place of that one. Returns once its first words are written. False: the
  /// world's thread does not take it; try again.
  bool take_over(std::uint64_t primary, const SpokenBefore& before, const std::string& why);
  /// Waits until this server has what another one had of each publisher, a moment at most.
  void catch_up(const PublisherProgress& progress);

  /// A server that stands by for this one and may take its place now.
  struct Heir {
    std::uint64_t server = 0;
    std::string name;
  };
  /// name  of the member; empty: any
  /// returns  nothing, too, where this server is not the primary, or not any more
  std::optional<Heir> heir(const std::string& name) const;
  /// This server is to hand over to that one when it ends.
  void choose(const std::string& name);
  /// Who was chosen, once; empty: nobody.
  std::string take_choice();
  /// Hands over, and waits until that one is the primary. False: it does not take the place, or has left, and this server
  /// goes on.
  /// Nothing else may change the world meanwhile.
  bool hand_over(ChangeFeed& feed, const Heir& to);
  /// Whether this server ends since another one is the primary now without having been asked to.
  bool has_given_way() const { return has_given_way_.load(); }

 private:
  struct StandsBy {
    std::string name;
    bool is_ready = false;
    std::int64_t heard_ns = 0;  // steady clock
  };
  /// Has the world's thread do it, and waits. False: it does not come to it.
  bool done_on_world_thread(std::function<void()> job) const;
  bool stands_by(std::uint64_t server) const;
  void give_way(const std::string& why);

  const Collaborators with_;
  std::atomic<wire_contract::MemberRole> role_;
  std::atomic<std::uint64_t> predecessor_{0};
  std::atomic<bool> hands_over_{false};
  std::atomic<bool> has_heir_{false};
  std::atomic<bool> has_given_way_{false};
  mutable std::mutex mutex_;  // for these two
  std::map<std::uint64_t, StandsBy> followers_;
  std::string chosen_;
};

}  // namespace collided::engine::service
