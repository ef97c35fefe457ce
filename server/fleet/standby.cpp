#include "server/fleet/standby.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::MemberRole;
using wire_contract::ServerState;

/// Instants in a row at which the worlds differ before that is reported: publishers need a moment to say all again, and
/// what commands do is done here a moment later.
constexpr std::uint64_t kReported = 8;
/// Instants in a row at which two worlds that were the same differ before this server may no longer take the place: a sample
/// that comes to one of the two a second late is in that one's next instant, and what is really lost is missing in all.
constexpr std::uint64_t kConfirmed = 2;

}  // namespace

Standby::Standby(const dds::Participant& participant, const Identity& identity,
                 const ChangeFollower::Collaborators& with, const PlaceRules& rules, PlaceCollaborators place)
    : with_(with),
      self_(identity.server),
      epoch_(identity.epoch),
      rules_(rules),
      place_(std::move(place)),
      follower_(participant, identity.server, identity.name_space, with) {
  if (rules.silent_after_ns == 0) return;
  pulse_.emplace(participant, identity.name_space, rules.silent_after_ns,
                 PrimaryPulse::Collaborators{.primary = [this] { return follower_.primary(); },
                                             .is_silent = [this](std::int64_t silent_ns) { return succeed(silent_ns); },
                                             .is_replaced = place_.has_place});
}

void Standby::leave() {
  {
    const std::lock_guard lock(taking_mutex_);
    has_left_ = true;
  }
  pulse_.reset();
  follower_.leave();
}

void Standby::hear(const OtherMember& other) {
  if (other.role == MemberRole::replica) return;
  if (other.role != MemberRole::primary) return hear_rival(other);
  follower_.follow(other.server, other.name);
  if (follower_.primary() != other.server) return hear_another_primary(other);
  note_primary(other);
  is_outranked_.store(!rules_.is_replica && other.epoch >= epoch_.load());
  if (is_outranked_.load() || shares_epoch()) {
    raise_epoch();
  } else {
    const std::lock_guard lock(mutex_);
    epoch_problem_.clear();
  }
  if (!pulse_ || !pulse_->is_silent()) is_left_alone_.store(false);
  comparison_.hear(other.digest);
  judge();
}

void Standby::hear_rival(const OtherMember& rival) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = steady_ns();
  std::erase_if(rivals_, [&](const auto& entry) { return now_ns - entry.second.heard_ns > kMemberGoneNs; });
  rivals_[rival.server] = {.epoch = rival.epoch, .is_ready = rival.state == ServerState::ready, .heard_ns = now_ns};
}

/// With another one that stands by, as two that are started at once. Were both to take the place, nobody could tell which is
/// the later one: one of the two raises its own.
bool Standby::shares_epoch() const {
  if (rules_.is_replica) return false;
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(rivals_, [&](const auto& entry) {
    const auto& [server, rival] = entry;
    return rival.epoch == epoch_.load() && server < self_ && steady_ns() - rival.heard_ns < kMemberGoneNs;
  });
}

void Standby::hear_another_primary(const OtherMember& other) {
  {
    // One whose place was taken, and which goes on after it was stopped, gives way as soon as it hears of that.
    const std::lock_guard lock(mutex_);
    const bool is_there_a_later_one = steady_ns() - primary_heard_ns_ < kMemberGoneNs;
    if (is_there_a_later_one && other.epoch < primary_epoch_) return;
  }
  if (!turn_to(other))
    refuse_for_good(
        fmt::format("'{}' is primary now, and another one was followed; start this server again", other.name));
}

/// False: what that primary has need not go with what this server has. Until the two have been compared, this one does not
/// take its place either.
bool Standby::turn_to(const OtherMember& heir) {
  if (heir.following.primary != follower_.primary() || heir.following.fetch == 0) return false;
  if (!follower_.follow_heir(heir.server, heir.name, heir.following.fetch - 1)) return false;
  is_same_.store(false);
  turned_ns_.store(steady_ns());
  const std::lock_guard lock(mutex_);
  primary_epoch_ = heir.epoch;
  primary_heard_ns_ = steady_ns();
  return true;
}

/// Notes a record of the followed primary.
void Standby::note_primary(const OtherMember& primary) {
  bool has_turned = false;
  {
    const std::lock_guard lock(mutex_);
    has_turned = primary_server_ != 0 && primary_server_ != primary.server;
    primary_server_ = primary.server;
    primary_name_ = primary.name;
    primary_epoch_ = primary.epoch;
    primary_heard_ns_ = steady_ns();
    rivals_.erase(primary.server);
    if (has_turned) {
      first_to_differ_.clear();
      difference_.clear();
    }
  }
  if (!has_turned) return;
  is_same_.store(false);
  comparison_.begin_anew();
  with_.notice(fmt::format("'{}' has taken the primary's place, and is followed from now on", primary.name));
}

/// Above that of all others that are heard: whoever takes the primary's place has a greater epoch than all before.
void Standby::raise_epoch() {
  const std::lock_guard lock(taking_mutex_);
  if (has_place_ || has_left_ || place_.has_place()) return;
  std::uint64_t greatest = epoch_.load();
  {
    const std::lock_guard state_lock(mutex_);
    greatest = std::max(greatest, primary_epoch_);
    for (const auto& [server, rival] : rivals_) greatest = std::max(greatest, rival.epoch);
  }
  const RaisedEpoch raised = place_.raise_epoch(greatest + 1);
  if (raised.problem.empty()) {
    epoch_.store(raised.value);
    is_outranked_.store(false);
  }
  const std::string sentence =
      raised.problem.empty()
          ? std::string()
          : fmt::format("this server's epoch, {}, is not raised above {}: {}", epoch_.load(), greatest, raised.problem);
  bool is_news = false;
  {
    const std::lock_guard state_lock(mutex_);
    is_news = epoch_problem_.empty() && !sentence.empty();
    epoch_problem_ = sentence;
  }
  if (is_news) with_.notice(sentence);
}

void Standby::refuse_for_good(std::string sentence) {
  {
    const std::lock_guard lock(mutex_);
    if (!no_heir_.empty()) return;
    no_heir_ = sentence;
  }
  with_.notice(sentence);
  place_.cannot_follow();
}

/// How many others that stand by go before this one. Each waits for those before it.
int Standby::ready_before_this_one() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::ranges::count_if(rivals_, [&](const auto& entry) {
    const auto& [server, rival] = entry;
    const bool is_there = rival.is_ready && steady_ns() - rival.heard_ns < kMemberGoneNs;
    return is_there && std::pair(rival.epoch, server) > std::pair(epoch_.load(), self_);
  }));
}

/// True once this server is the primary.
bool Standby::succeed(std::int64_t silent_ns) {
  std::string name;
  {
    const std::lock_guard lock(mutex_);
    if (!no_heir_.empty() && !place_.has_place()) return false;
    name = primary_name_;
  }
  if (!may_take_place()) {
    // What it lacks comes, or that one falls silent too.
    if (steady_ns() - turned_ns_.load() < kMemberGoneNs && turned_ns_.load() != 0) return false;
    if (!is_left_alone_.exchange(true))
      with_.notice(fmt::format("'{}' has been silent for {} ms, and this server does not hold all that it had: {}",
                               name, silent_ns / 1'000'000, what_is_missing()));
    if (place_.has_place()) place_.cannot_follow();
    return false;
  }
  if (silent_ns < rules_.silent_after_ns * (1 + ready_before_this_one()) && !place_.has_place()) return false;
  return take_place(fmt::format("'{}' has been silent for {} ms", name, silent_ns / 1'000'000));
}

/// Once an authority has given the place to this server, the other one ends: what of the publishers' this one lacks, since it
/// was cut off, the publishers say again. What commands did there nobody says again.
bool Standby::may_take_place() const {
  if (place_.has_place()) return follower_.is_whole();
  return follower_.is_whole() && is_same_.load() && !is_outranked_.load();
}

/// Why may_take_place() says no.
std::string Standby::what_is_missing() const {
  if (!follower_.is_whole()) return "what commands did there has not come";
  const std::lock_guard lock(mutex_);
  if (!epoch_problem_.empty()) return epoch_problem_;
  if (first_to_differ_.empty()) return "the two worlds have not been found the same yet";
  return fmt::format("{} was not the same when the two worlds were compared last", first_to_differ_);
}

bool Standby::take_place(const std::string& why) {
  const std::lock_guard lock(taking_mutex_);
  if (has_place_) return true;
  if (has_left_ || !may_take_place()) return false;
  Predecessor of{
      .server = follower_.primary(),
      .spoken = {.heard_ns = pulse_ ? pulse_->heard_ns() : steady_ns(), .same_from_ns = same_from_ns_.load()},
      .is_same = is_same_.load()};
  // What differs was found by this server alone: nothing is told again, and what holds now stands in the state.
  if (!of.is_same) of.spoken.same_from_ns = std::numeric_limits<std::int64_t>::max();
  {
    const std::lock_guard state_lock(mutex_);
    if (primary_server_ != of.server) return false;  // it has just turned to that one, and not heard its epoch
    of.epoch = primary_epoch_;
  }
  if (!place_.take_over(of, why)) return false;
  has_place_ = true;
  follower_.give_up();
  return true;
}

void Standby::note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state) {
  comparison_.note_own(digest, std::move(state));
  judge();
}

void Standby::judge() {
  if (comparison_.compared() == judged_) return;
  judged_ = comparison_.compared();
  const bool is_equal = comparison_.differing() == 0;
  // Changes by commands are numbered and arrive complete, a moment after the primary made them: while commands go on, this waits.
  const bool is_on_its_way = !is_equal && comparison_.only_unpublished_differed() && follower_.has_carried_out_lately();
  const bool may_be_late = is_same_.load() && comparison_.differing() < kConfirmed;
  const bool is_same = is_equal || is_on_its_way || may_be_late;
  if (is_same && !is_same_.load()) same_from_ns_.store(comparison_.compared_to_ns());
  is_same_.store(is_same);
  if (compared_) compared_(comparison_.compared_to_ns(), is_equal && follower_.is_whole());
  if (is_on_its_way) return;
  // Ever more seldom: while publishers of many objects say all again, the two may be a moment apart.
  if (std::has_single_bit(comparison_.differing())) again_.fetch_add(1);
  const std::lock_guard lock(mutex_);
  if (is_same) {
    difference_.clear();
    return;
  }
  first_to_differ_ = comparison_.object().empty() ? std::string("an object that this server does not have")
                                                  : fmt::format("object '{}'", comparison_.object());
  if (comparison_.differing() < kReported) return;
  const bool is_new = difference_.empty();
  difference_ = fmt::format("the world is not the primary's: {} differs first", first_to_differ_);
  if (is_new) with_.notice(difference_);
}

Following Standby::following() const {
  return {.primary = follower_.primary(), .fetch = follower_.fetch(), .again = again_.load()};
}

ServerState Standby::state() const {
  const bool is_ready = follower_.is_whole() && is_same_.load() && !is_outranked_.load();
  return is_ready ? ServerState::ready : ServerState::recovering;
}

std::string Standby::alarm() const {
  std::string lines;
  const auto add = [&](const std::string& sentence) {
    if (!sentence.empty()) lines += (lines.empty() ? "" : "\n") + sentence;
  };
  for (const std::string& sentence : follower_.alarms()) add(sentence);
  if (is_left_alone_.load()) add("the primary is silent, and this server does not hold all that it had");
  const std::lock_guard lock(mutex_);
  add(difference_);
  add(epoch_problem_);
  add(no_heir_);
  return lines;
}

}  // namespace collided::engine::service
