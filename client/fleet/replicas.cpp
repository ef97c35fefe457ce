#include "client/fleet/replicas.hpp"

#include <algorithm>
#include <utility>

#include "client/library/connection/connection.hpp"
#include "idl/clocks.hpp"
#include "idl/host_name.hpp"

namespace collided::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::size_t kMostReplicas = 16;
/// Instants that are remembered, since one server may be some seconds ahead of the other.
constexpr std::size_t kMostSaid = 8;
/// A replica that says nothing for so long is not coming back by itself.
constexpr nanoseconds kForgotten = std::chrono::seconds(30);
/// How long a replica may take to answer the first greeting; it is greeted again later.
constexpr nanoseconds kGreeting = milliseconds(500);

/// Whether another server may have a better answer than this one of a replica: of a later state, where this client has seen
/// one, or with an object that is still on its way to the replica.
bool is_behind(const Answers& answers, const AskOptions& options, std::int64_t seen_settled_ns) {
  if (options.as_of.kind == Instant::Kind::settled) return answers.world_time.count() < seen_settled_ns;
  return options.as_of.kind == Instant::Kind::at && std::ranges::any_of(answers.answers, [](const Answer& answer) {
           return answer.reason == UndecidedReason::stale_object;
         });
}

}  // namespace

std::unique_ptr<Route> make_route(Connection& primary) { return std::make_unique<Replicas>(primary); }

Replicas::AskedServer::~AskedServer() {
  if (!place_) return;
  const std::lock_guard lock(owner_.mutex_);
  --place_->asked;
}

Replicas::Replicas(Connection& primary)
    : primary_(primary), own_place_(std::make_shared<ReplicaPlace>()), host_(wire_contract::host_name()) {}

Replicas::~Replicas() {
  is_over_.store(true);
  if (!thread_.joinable()) return;
  waitset_->wake();
  thread_.join();
}

bool Replicas::is_usable(const ReplicaPlace& place) const {
  if (!place.connection || place.same_at_ns <= changed_ns_) return false;
  const ServerPulse& pulse = place.connection->pulse();
  return pulse.is_ready() && !pulse.silent();
}

Replicas::AskedServer Replicas::next(bool as_primary) {
  if (!has_company()) return {*this, nullptr, nullptr};
  const std::lock_guard lock(mutex_);
  // A program that asks once and ends need not know.
  if (turn_ > 0 && !std::exchange(is_looking_, true)) {
    waitset_ = std::make_unique<dds::WaitSet>(primary_.participant());
    thread_ = std::thread([this] { run(); });
  }
  const bool is_primary_there = !primary_.pulse().silent();
  std::vector<std::shared_ptr<ReplicaPlace>> could;
  if (is_primary_there) could.push_back(own_place_);
  if (!as_primary || !is_primary_there) {
    for (const auto& [name, place] : places_) {
      if (is_usable(*place)) could.push_back(place);
    }
  }
  if (could.empty()) could.push_back(own_place_);
  // From another one each time, so that the first of several with as few questions is not always the same.
  std::ranges::rotate(could, could.begin() + static_cast<std::ptrdiff_t>(turn_++ % could.size()));
  const std::shared_ptr<ReplicaPlace> chosen = *std::ranges::min_element(
      could, {}, [](const auto& place) { return std::pair(place->asked, place->is_elsewhere); });
  ++chosen->asked;
  return {*this, chosen, chosen->connection};
}

std::optional<Error> Replicas::ask(const AskOnce& once, const AskOptions& options, const Answers& answers,
                                   Clock::time_point deadline) {
  constexpr int kMostTries = 4;  // where the primary is silent, so that replicas are tried again
  constexpr milliseconds kLook{1};
  const std::int64_t seen_settled_ns = settled_ns_.load(std::memory_order_relaxed);
  const Clock::time_point waits_until = deadline - options.timeout / 2;
  for (int tries = 1;; ++tries) {
    const AskedServer asked = next(tries > 1);
    const std::optional<Error> error = once(asked.replica() == nullptr ? primary_ : *asked.replica());
    const bool is_gone = error && error->code == ErrorCode::disconnected;
    const bool is_poor = error || is_behind(answers, options, seen_settled_ns);
    const bool may_others_know = is_gone || (asked.replica() != nullptr && is_poor);
    if (may_others_know && tries < kMostTries && Clock::now() < deadline) continue;
    if (error || options.as_of.kind != Instant::Kind::settled) return error;
    if (answers.world_time.count() >= seen_settled_ns || Clock::now() >= waits_until) break;
    std::this_thread::sleep_for(kLook);
  }
  note_settled(answers.world_time.count());
  return std::nullopt;
}

void Replicas::note_change(std::int64_t world_time_ns) {
  const std::lock_guard lock(mutex_);
  changed_ns_ = std::max(changed_ns_, world_time_ns);
}

void Replicas::note_possible_change() {
  // The server's clock may be ahead of this machine's, and it may still be at it.
  constexpr std::int64_t kSlackNs = 1'000'000'000;
  note_change(wire_contract::since_1970_ns() + kSlackNs);
}

void Replicas::note_settled(std::int64_t world_time_ns) {
  std::int64_t newest_ns = settled_ns_.load(std::memory_order_relaxed);
  while (newest_ns < world_time_ns && !settled_ns_.compare_exchange_weak(newest_ns, world_time_ns)) {}
}

void Replicas::run() {
  try {
    constexpr std::int64_t kLookNs = 250'000'000;
    const dds::Topic<wire::Member> topic(primary_.participant(), primary_.options().name_space);
    dds::Reader<wire::Member> reader(topic);
    dds::Sample<wire::Member> sample;
    waitset_->attach(reader, 1);
    while (!is_over_.load()) {
      waitset_->wait(kLookNs);
      take(reader, sample);
      forget_gone();
      connect_new();
    }
  } catch (const dds::DdsError&) {}  // without the right to hear who is there, the primary is asked
}

void Replicas::take(dds::Reader<wire::Member>& reader, dds::Sample<wire::Member>& sample) {
  while (reader.take(sample)) {
    if (sample.info().valid_data && sample.info().instance_state == DDS_ALIVE_INSTANCE_STATE) hear(*sample);
  }
}

void Replicas::hear(const wire::Member& member) {
  const std::lock_guard lock(mutex_);
  const bool is_primary = member.server == primary_.pulse().server();
  if (!is_primary && member.role != static_cast<std::uint8_t>(wire_contract::MemberRole::replica)) return;
  if (!is_primary && places_.size() >= kMostReplicas && !places_.contains(member.name)) return;
  if (!is_primary && !places_.contains(member.name)) places_[member.name] = std::make_shared<ReplicaPlace>();
  ReplicaPlace& place = is_primary ? *own_place_ : *places_[member.name];
  // One that was started again has its world to show first.
  if (std::exchange(place.server, member.server) != member.server) {
    place.said.clear();
    place.same_at_ns = 0;
  }
  place.heard = Clock::now();
  place.is_elsewhere = member.host != host_;
  const bool is_new =
      member.digest_time_ns != 0 && (place.said.empty() || place.said.back().time_ns < member.digest_time_ns);
  if (!is_new) return;
  place.said.push_back({member.digest_time_ns, wire_contract::digest_hash(dds::view(member.digest))});
  if (place.said.size() > kMostSaid) place.said.pop_front();
  for (const auto& [name, other] : places_) compare(*other);
}

void Replicas::compare(ReplicaPlace& place) const {
  for (const SaidWorld& said : place.said) {
    const auto own = std::ranges::find(own_place_->said, said.time_ns, &SaidWorld::time_ns);
    if (own != own_place_->said.end() && own->hash == said.hash) place.same_at_ns = said.time_ns;
  }
}

void Replicas::forget_gone() {
  std::vector<std::shared_ptr<ReplicaPlace>> gone;  // closed without the lock
  const std::lock_guard lock(mutex_);
  std::erase_if(places_, [&](const auto& entry) {
    if (Clock::now() - entry.second->heard < kForgotten) return false;
    gone.push_back(entry.second);
    return true;
  });
}

/// Greets the replicas that are new, one after the other.
void Replicas::connect_new() {
  std::vector<std::pair<std::string, std::shared_ptr<ReplicaPlace>>> fresh;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, place] : places_) {
      if (!place->connection && Clock::now() - place->heard < kGreeting) fresh.emplace_back(name, place);
    }
  }
  for (const auto& [name, place] : fresh) {
    if (is_over_.load()) return;
    std::shared_ptr<Connection> connection = Connection::open_beside(
        primary_, wire_contract::replica_namespace(primary_.options().name_space, name), kGreeting);
    const std::lock_guard lock(mutex_);
    place->connection = std::move(connection);
  }
}

}  // namespace collided::client
