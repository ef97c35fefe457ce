#include "server/service/questions/snapshot_leases.hpp"

#include <algorithm>

#include "idl/columns.hpp"
#include "server/service/questions/ask.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {

void SnapshotLeases::Hold::release() {
  SnapshotLeases* book = std::exchange(book_, nullptr);
  state_ = {};
  if (book) book->done(key_);
}

SnapshotLeases::SnapshotLeases(const World& world) : world_(world) {
  entries_.reserve(kMostRequests);
  waiting_.reserve(kMostWaiting);
}

SnapshotLeases::~SnapshotLeases() {
  for (auto& ask : waiting_) ask->hold = {};
}

SnapshotLeases::Entries::iterator SnapshotLeases::find(const std::pair<std::uint64_t, std::uint64_t>& key) {
  return std::ranges::find(entries_, key, &Entry::key);
}

/// How many different states are pinned; leases of the same state point to the same snapshot.
std::size_t SnapshotLeases::states() const {
  std::size_t count = 0;
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (!entry->state) continue;
    const bool is_seen = std::any_of(
        entries_.begin(), entry, [&](const Entry& other) { return other.state && &*other.state == &*entry->state; });
    if (!is_seen) ++count;
  }
  return count;
}

/// The newest state, or if too many are pinned the youngest of these if it is new enough; else nothing.
SnapshotRing::Lease SnapshotLeases::state_for(std::uint64_t least_version, std::int64_t now_ns) const {
  SnapshotRing::Lease newest = world_.newest();
  const Entry* youngest = nullptr;
  for (const Entry& entry : entries_) {
    if (!entry.state) continue;
    if (&*entry.state == &*newest) return newest;
    if (youngest == nullptr || entry.pinned_ns >= youngest->pinned_ns) youngest = &entry;
  }
  if (states() < kMostStates) return newest;
  const bool will_do = youngest->state->version >= least_version && now_ns - youngest->pinned_ns <= kSharedAgeNs;
  return will_do ? youngest->state : SnapshotRing::Lease();
}

bool SnapshotLeases::has_room_for(std::size_t bytes, std::size_t most_bytes) const {
  return waiting_.size() < kMostWaiting && waiting_bytes_ + bytes <= most_bytes;
}

void SnapshotLeases::hold(Ask& ask, const Entry& entry) {
  SnapshotLeases::Hold hold;
  hold.book_ = this;
  hold.key_ = entry.key;
  hold.state_ = entry.state;
  ask.hold = std::move(hold);
}

SnapshotLeases::Taken SnapshotLeases::take(std::unique_ptr<Ask>& ask, std::uint64_t least_version,
                                           std::int64_t now_ns) {
  const wire::Query& query = *ask->query;
  const std::pair key(query.client, query.request);
  const std::size_t bytes = wire::bytes_of(query);
  const std::lock_guard lock(mutex_);
  auto entry = find(key);
  if (entry == entries_.end()) {
    if (query.chunk_index != 0) return Taken::gone;
    if (entries_.size() >= kMostRequests) return Taken::full;
    // Chunks that wait already come first.
    const bool may_pin = waiting_.empty();
    Entry made{.key = key, .chunks_left = query.chunk_count, .least_version = least_version, .pinned_ns = now_ns};
    if (may_pin) made.state = state_for(least_version, now_ns);
    // Several chunks of a request are in flight at once, so its first may use only its share of the room.
    constexpr std::size_t kMostFirstBytes = kMostWaitingBytes / wire_contract::kChunksInFlight;
    if (!made.state && !has_room_for(bytes, kMostFirstBytes)) return Taken::full;
    entry = entries_.insert(entries_.end(), std::move(made));
  }
  if (!entry->state && !has_room_for(bytes, kMostWaitingBytes)) return Taken::full;
  ++entry->at_hand;
  if (!entry->state) {
    waiting_bytes_ += bytes;
    waiting_.push_back(std::move(ask));
    return Taken::waits;
  }
  hold(*ask, *entry);
  return Taken::pinned;
}

bool SnapshotLeases::keep(Ask& ask, const SnapshotRing::Lease& state, std::int64_t now_ns) {
  const wire::Query& query = *ask.query;
  const std::pair key(query.client, query.request);
  const std::lock_guard lock(mutex_);
  if (entries_.size() >= kMostRequests || find(key) != entries_.end()) return false;
  const bool is_kept =
      std::ranges::any_of(entries_, [&](const Entry& entry) { return entry.state && &*entry.state == &*state; });
  if (!is_kept && states() >= kMostStates) return false;
  entries_.push_back({.key = key,
                      .chunks_left = 1,
                      .at_hand = 1,
                      .least_version = state->version,
                      .pinned_ns = now_ns,
                      .state = state});
  hold(ask, entries_.back());
  return true;
}

SnapshotLeases::Hold SnapshotLeases::share(const Hold& hold) {
  Hold shared;
  const std::lock_guard lock(mutex_);
  const auto entry = find(hold.key_);
  // The entry exists as long as any chunk of its request is at hand.
  ++entry->at_hand;
  ++entry->chunks_left;
  shared.book_ = this;
  shared.key_ = hold.key_;
  shared.state_ = hold.state_;
  return shared;
}

/// A chunk is answered or given up.
void SnapshotLeases::done(const std::pair<std::uint64_t, std::uint64_t>& key) {
  const std::int64_t now_ns = steady_ns();
  {
    const std::lock_guard lock(mutex_);
    const auto entry = find(key);
    if (entry == entries_.end()) return;  // its client kept others waiting
    --entry->at_hand;
    if (entry->chunks_left > 0) --entry->chunks_left;
    if (entry->at_hand == 0) {
      entry->idle_since_ns = now_ns;
      if (entry->chunks_left == 0) entries_.erase(entry);
    }
    if (waiting_.empty()) return;
  }
  hand_out(now_ns);
}

/// The oldest chunk whose request has a state, or for which there is one now; null if there is none.
std::unique_ptr<Ask> SnapshotLeases::next_ready(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  for (auto at = waiting_.begin(); at != waiting_.end(); ++at) {
    const auto entry = find({(**at).query->client, (**at).query->request});
    if (!entry->state) {
      entry->state = state_for(entry->least_version, now_ns);
      entry->pinned_ns = now_ns;
    }
    if (!entry->state) continue;
    std::unique_ptr<Ask> ask = std::move(*at);
    waiting_bytes_ -= wire::bytes_of(*ask->query);
    waiting_.erase(at);
    hold(*ask, *entry);
    return ask;
  }
  return nullptr;
}

void SnapshotLeases::hand_out(std::int64_t now_ns) {
  while (std::unique_ptr<Ask> ask = next_ready(now_ns)) ready_(std::move(ask));
}

void SnapshotLeases::expire(std::int64_t now_ns) {
  {
    const std::lock_guard lock(mutex_);
    const std::int64_t before_ns = std::exchange(expired_ns_, now_ns);
    const bool is_contended = !waiting_.empty();
    std::erase_if(entries_, [&](Entry& entry) {
      if (entry.at_hand > 0) return false;
      if (is_contended) entry.kept_waiting_ns += now_ns - std::max(before_ns, entry.idle_since_ns);
      return entry.kept_waiting_ns > kPatienceNs || now_ns - entry.idle_since_ns > kLongestPauseNs;
    });
    if (!is_contended) return;
  }
  hand_out(now_ns);
}

std::vector<std::unique_ptr<Ask>> SnapshotLeases::take_waiting() {
  const std::lock_guard lock(mutex_);
  std::vector<std::unique_ptr<Ask>> waiting = std::exchange(waiting_, {});
  waiting_bytes_ = 0;
  for (const auto& ask : waiting) {
    const auto entry = find({ask->query->client, ask->query->request});
    if (entry != entries_.end() && !entry->state) entries_.erase(entry);
  }
  return waiting;
}

std::size_t SnapshotLeases::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace collided::engine::service
