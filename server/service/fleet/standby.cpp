#include "server/service/fleet/standby.hpp"

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace collided::engine::service {
namespace {

using wire_contract::MemberRole;
using wire_contract::ServerState;

/// Instants in a row at which the worlds differ before that is reported: publishers need a moment to say all again, and
/// what commands do is done here a moment later.
constexpr std::uint64_t kReported = 8;

}  // namespace

Standby::Standby(const dds::Participant& participant, const Identity& identity,
                 const ChangeFollower::Collaborators& with)
    : with_(with), follower_(participant, identity.server, identity.name_space, with) {}

void Standby::hear(const OtherMember& other) {
  if (other.role != MemberRole::primary) return;
  follower_.follow(other.server, other.name);
  if (follower_.primary() != other.server) {
    const std::lock_guard lock(mutex_);
    if (!other_primary_.empty()) return;
    other_primary_ =
        fmt::format("'{}' is primary now, and another one was followed; start this server again", other.name);
    return with_.notice(other_primary_);
  }
  comparison_.hear(other.digest);
  judge();
}

void Standby::note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state) {
  comparison_.note_own(digest, std::move(state));
  judge();
}

void Standby::judge() {
  if (comparison_.compared() == judged_) return;
  judged_ = comparison_.compared();
  is_same_.store(comparison_.differing() == 0);
  // Ever more seldom: while publishers of many objects say all again, the two may be a moment apart.
  if (std::has_single_bit(comparison_.differing())) again_.fetch_add(1);
  const std::lock_guard lock(mutex_);
  if (comparison_.differing() < kReported) {
    if (comparison_.differing() == 0) difference_.clear();
    return;
  }
  const std::string object = comparison_.object().empty() ? std::string("an object that this server does not have")
                                                          : fmt::format("object '{}'", comparison_.object());
  const bool is_new = difference_.empty();
  difference_ = fmt::format("the world is not the primary's: {} differs first", object);
  if (is_new) with_.notice(difference_);
}

Following Standby::following() const {
  return {.primary = follower_.primary(), .fetch = follower_.fetch(), .again = again_.load()};
}

ServerState Standby::state() const {
  return follower_.is_whole() && is_same_.load() ? ServerState::ready : ServerState::recovering;
}

std::string Standby::alarm() const {
  std::string lines;
  const auto add = [&](const std::string& sentence) {
    if (!sentence.empty()) lines += (lines.empty() ? "" : "\n") + sentence;
  };
  for (const std::string& sentence : follower_.alarms()) add(sentence);
  const std::lock_guard lock(mutex_);
  add(difference_);
  add(other_primary_);
  return lines;
}

}  // namespace collided::engine::service
