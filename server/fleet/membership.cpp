#include "server/fleet/membership.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "idl/clocks.hpp"
#include "idl/host_name.hpp"
#include "idl/topics.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::MemberRole;

/// Clocks that are farther apart are reported: events of objects of two publishers are dated by such clocks.
constexpr std::int64_t kClocksApartNs = 20'000'000;
/// More servers of one namespace than anybody runs; others are not looked at.
constexpr std::size_t kMostOthers = 64;

/// A role that this version does not know is taken for one that decides nothing.
MemberRole role_in(const wire::Member& member) {
  return wire_contract::is_known<MemberRole>(member.role) ? static_cast<MemberRole>(member.role) : MemberRole::replica;
}

/// As much of a text as fits into a field.
template <std::size_t kRoom>
void set_cut(char (&field)[kRoom], std::string_view text) {
  static_cast<void>(dds::set_text(field, text.substr(0, kRoom - 1)));
}

WorldDigest digest_in(const wire::Member& member) {
  WorldDigest digest;
  const auto sums = dds::view(member.digest);
  if (sums.size() == digest.sums.size()) std::ranges::copy(sums, digest.sums.begin());
  return digest;
}

/// By how much the other's clock is ahead, by the sample that came quickest; negative: behind.
std::int64_t clock_ahead_of(const OtherMember& other) {
  return other.clock_ahead_ns.empty() ? 0 : *std::ranges::max_element(other.clock_ahead_ns);
}

}  // namespace

std::string member_name(const std::string& given) {
  return given.empty() ? fmt::format("{}-{}", wire_contract::host_name(), getpid()) : given;
}

Membership::Membership(const dds::Participant& participant, const Identity& identity, SelfDescription self,
                       const World& world, const WorldClock& clock, Notice notice)
    : self_(std::move(self)),
      world_(world),
      clock_(clock),
      notice_(std::move(notice)),
      identity_(identity),
      topic_(participant, identity.name_space),
      writer_(topic_),
      reader_(topic_),
      waitset_(participant),
      digests_(world) {
  waitset_.attach(reader_, 1);
  said_->server = identity.server;
  said_->pid = static_cast<std::uint32_t>(getpid());
  set_cut(said_->name, self_.name);
  set_cut(said_->host, wire_contract::host_name());
  set_cut(said_->server_version, identity.version);
  said_->started_ns = wire_contract::since_1970_ns();
  thread_ = named_thread("fleet", [this] { run(); });
}

Membership::~Membership() { leave(); }

void Membership::leave() {
  if (!thread_.joinable()) return;
  is_over_.store(true);
  waitset_.wake();
  thread_.join();
  try {
    writer_.dispose(*said_);
  } catch (const dds::DdsError&) {}  // the others learn by its silence, then
}

void Membership::say_now() {
  says_now_.store(true);
  waitset_.wake();
}

void Membership::run() {
  std::int64_t next_ns = steady_ns();
  while (!is_over_.load()) {
    waitset_.wait(std::max<std::int64_t>(0, next_ns - steady_ns()));
    take();
    if (!says_now_.exchange(false) && steady_ns() < next_ns) continue;
    next_ns = steady_ns() + wire_contract::kMemberPeriodNs;
    if (!others_.empty() && digests_.make(clock_.now_ns(), self_.settled_ns())) self_.digested(digests_);
    report(faults());
    write();
  }
}

void Membership::take() {
  while (reader_.take(heard_)) {
    if (heard_->server == identity_.server) continue;
    if (heard_.info().instance_state != DDS_ALIVE_INSTANCE_STATE) {
      others_.erase(heard_->server);
      self_.gone(heard_->server);
    } else if (heard_.info().valid_data) {
      hear(heard_);
      if (const auto other = others_.find(heard_->server); other != others_.end()) self_.heard(other->second);
    }
  }
}

void Membership::hear(const dds::Sample<wire::Member>& sample) {
  if (others_.size() >= kMostOthers && !others_.contains(sample->server)) return;
  const bool is_known = others_.contains(sample->server);
  OtherMember& other = others_[sample->server];
  other.server = sample->server;
  other.heard_ns = steady_ns();
  other.epoch = sample->epoch;
  other.role = role_in(*sample);
  other.state = static_cast<wire_contract::ServerState>(sample->state);
  other.name = sample->name;
  other.host = sample->host;
  other.version = sample->server_version;
  other.scene_fingerprint = sample->scene_fingerprint;
  other.following = {.primary = sample->primary, .fetch = sample->fetch, .again = sample->again};
  other.digest = {.time_ns = sample->digest_time_ns, .digest = digest_in(*sample)};
  // What DDS kept for a reader that joins may be old.
  if (!is_known) return;
  constexpr std::size_t kMost = 8;
  other.clock_ahead_ns.push_back(sample->clock_ns - wire_contract::since_1970_ns());
  if (other.clock_ahead_ns.size() > kMost) other.clock_ahead_ns.pop_front();
}

/// What does not fit together: a sentence for each, by what it is about and the other's number.
Membership::Faults Membership::faults() const {
  Faults found;
  const std::uint64_t fingerprint = said_->scene_fingerprint;
  for (const auto& [server, other] : others_) {
    const bool is_there = steady_ns() - other.heard_ns < kMemberGoneNs;
    // Whose place was taken has fallen silent; were it to go on, it would be heard, and give way.
    const bool is_predecessor =
        self_.following().primary == server && steady_ns() - other.heard_ns > 2 * wire_contract::kMemberPeriodNs;
    if (is_there && !is_predecessor && other.role == MemberRole::primary && self_.role() == MemberRole::primary)
      found[{"primaries", server}] = fmt::format(
          "two primaries: '{}' (epoch {}) serves this namespace too, and answers may differ; stop one of the two",
          other.name, other.epoch);
    if (other.version != identity_.version)
      found[{"versions", server}] =
          fmt::format("two versions: '{}' is {}, this is {}", other.name, other.version, identity_.version);
    if (fingerprint != 0 && other.scene_fingerprint != 0 && other.scene_fingerprint != fingerprint)
      found[{"scenes", server}] =
          fmt::format("different scenes: those of '{}' are not those that are loaded here", other.name);
    const std::int64_t ahead_ns = clock_ahead_of(other);
    // On one machine both have one clock, and what is seen is how long messages took.
    if (other.host != said_->host && std::abs(ahead_ns) > kClocksApartNs)
      found[{"clocks", server}] = fmt::format("clocks apart: that of '{}' is {} ms {}", other.name,
                                              std::abs(ahead_ns) / 1'000'000, ahead_ns > 0 ? "ahead" : "behind");
  }
  return found;
}

/// Reports each fault once it has lasted: a scene that is being loaded is on one server first.
void Membership::report(const Faults& found) {
  constexpr int kLasting = 4;  // looks in a row
  std::erase_if(looks_, [&](const auto& entry) { return !found.contains(entry.first); });
  for (const auto& [about, sentence] : found) {
    if (++looks_[about] == kLasting) notice_("fleet: " + sentence);
  }
}

void Membership::write() {
  const SnapshotRing::Lease newest = world_.newest();
  said_->epoch = self_.epoch();
  said_->role = static_cast<std::uint8_t>(self_.role());
  said_->state = static_cast<std::uint8_t>(self_.state());
  said_->version = newest->version;
  said_->lag_ns = std::max<std::int64_t>(0, newest->world_time_ns - newest->settled_ns);
  const Following following = self_.following();
  said_->primary = following.primary;
  said_->fetch = following.fetch;
  said_->again = following.again;
  said_->scene_fingerprint = digests_.scene_fingerprint();
  said_->digest_time_ns = digests_.newest().time_ns;
  if (said_->digest_time_ns != 0) dds::borrow(said_->digest, digests_.newest().digest.sums);
  set_cut(said_->alarm, self_.alarm());
  said_->clock_ns = wire_contract::since_1970_ns();
  try {
    static_cast<void>(writer_.write(*said_));
  } catch (const dds::DdsError&) {}  // said again at the next look
}

}  // namespace collided::engine::service
