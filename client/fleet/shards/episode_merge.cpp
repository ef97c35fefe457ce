#include "client/fleet/shards/episode_merge.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <ranges>

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

// The same instant as two servers tell it: each rounds its distance from a step of its own.
constexpr nanoseconds kRounded{2};

/// The two objects in the order of their names: numbers, and with them the order, differ from shard to shard.
Event in_order_of_names(Event event) {
  event.a_id = event.b_id = 0;
  if (event.a <= event.b) return event;
  std::swap(event.a, event.b);
  std::swap(event.a_triangle, event.b_triangle);
  if (event.contained != Containment::none) {
    event.contained = event.contained == Containment::a_in_b ? Containment::b_in_a : Containment::a_in_b;
  }
  event.normal = -event.normal;
  event.surface_normal = -event.surface_normal;
  event.relative_velocity = -event.relative_velocity;
  return event;
}

}  // namespace

/// True if the pair itself ended; false if only the contact held by that shard did.
///
/// instant  all events of the pair at that time
bool EpisodeMerge::is_of_pair(const HeardEvent& heard, std::span<const HeardEvent> instant, const PairState& pair) {
  switch (heard.event.reason) {
    case EndReason::removed:
    case EndReason::server_stopping:
    case EndReason::server_restarted: return false;
    // The contact goes on in doubt, of which the others will say the same.
    case EndReason::publisher_lost:
      return std::ranges::any_of(instant, [&](const HeardEvent& other) {
        return other.shard == heard.shard && other.event.kind == EventKind::began &&
               other.event.doubt == Doubt::publisher_lost;
      });
    // In a shard that was away objects are placed again; an object that jumps ends the contact in all shards at once.
    case EndReason::teleported: {
      shards::ShardSet placed = 0;
      for (const HeardEvent& other : instant) {
        if (other.event.kind == EventKind::ended && other.event.reason == EndReason::teleported)
          placed |= shards::set_of(other.shard);
      }
      return (pair.open & ~placed) == 0;
    }
    default: return true;
  }
}

/// Which shards say what of the pair, with this event.
void EpisodeMerge::note(PairState& pair, const HeardEvent& heard) {
  const shards::ShardSet shard = shards::set_of(heard.shard);
  // Pending reports of other shards about an ended pair are superseded.
  const shards::ShardSet over = heard.is_of_pair ? ~shards::ShardSet{0} : shard;
  switch (heard.event.kind) {
    case EventKind::open:
      pair.open |= shard;
      if (heard.event.contained != Containment::none) pair.contained |= shard;
      break;
    case EventKind::began: pair.open |= shard; break;
    case EventKind::ended:
      pair.open &= ~over;
      pair.contained &= ~over;
      break;
    case EventKind::contained: pair.contained |= shard; break;
    case EventKind::emerged: pair.contained &= ~over; break;
    case EventKind::persisted: break;
  }
}

void EpisodeMerge::hear(std::size_t shard, const Event& event) {
  if (event.kind == EventKind::persisted) return;
  HeardEvent heard{.at = happened(event), .order = order_++, .shard = shard, .event = in_order_of_names(event)};
  // What held when the shard's events were first heard comes before all of them.
  if (event.kind == EventKind::open) heard.at = std::min(event.began, heard.at);
  pending_[{heard.event.a, heard.event.b}].push_back(std::move(heard));
}

void EpisodeMerge::forget(std::size_t shard) {
  for (auto entry = pending_.begin(); entry != pending_.end();) {
    std::erase_if(entry->second, [&](const HeardEvent& heard) { return heard.shard == shard; });
    entry = entry->second.empty() ? pending_.erase(entry) : std::next(entry);
  }
  for (auto& [names, pair] : pairs_) {
    pair.open &= ~shards::set_of(shard);
    pair.contained &= ~shards::set_of(shard);
  }
}

/// Sorts the events of a pair by time, with those of each shard in the order in which they came: a removal has the time of its
/// server's clock, which may be ahead of the publishers' next poses.
void EpisodeMerge::sort_by_time(std::vector<HeardEvent>& of_pair) {
  std::array<nanoseconds, shards::ShardMap::kMostShards> next_at;
  next_at.fill(nanoseconds::max());
  for (HeardEvent& heard : std::views::reverse(of_pair))
    heard.at = next_at[heard.shard] = std::min(heard.at, next_at[heard.shard]);
  std::ranges::sort(of_pair, {}, [](const HeardEvent& heard) { return std::pair(heard.at, heard.order); });
}

void EpisodeMerge::settle(nanoseconds through) {
  std::vector<std::vector<HeardEvent>> instants;
  for (auto entry = pending_.begin(); entry != pending_.end();) {
    std::vector<HeardEvent>& of_pair = entry->second;
    sort_by_time(of_pair);
    const auto end = std::ranges::upper_bound(of_pair, through, {}, &HeardEvent::at);
    // What a pair's shards tell within the roundings is one instant of it.
    for (auto first = of_pair.begin(); first != end;) {
      const auto last = std::find_if(first, end, [&](const auto& heard) { return heard.at > first->at + kRounded; });
      instants.emplace_back(std::make_move_iterator(first), std::make_move_iterator(last));
      first = last;
    }
    of_pair.erase(of_pair.begin(), end);
    entry = of_pair.empty() ? pending_.erase(entry) : std::next(entry);
  }
  std::ranges::stable_sort(instants, {}, [](const auto& instant) { return instant.front().at; });
  for (std::vector<HeardEvent>& instant : instants) settle_instant(instant);
}

/// One instant of a pair. A shard may tell several events of it, each in its turn: what all of them have ended has ended,
/// though each of them says next that it began anew.
void EpisodeMerge::settle_instant(std::span<HeardEvent> instant) {
  const Names names(instant.front().event.a, instant.front().event.b);
  std::ranges::sort(instant, {}, &HeardEvent::order);
  std::array<std::size_t, shards::ShardMap::kMostShards> turn_of{};
  std::vector<std::vector<HeardEvent*>> turns;
  for (HeardEvent& heard : instant) {
    const std::size_t turn = turn_of[heard.shard]++;
    if (turn == turns.size()) turns.emplace_back();
    turns[turn].push_back(&heard);
  }
  PairState& pair = pairs_[names];
  for (HeardEvent& heard : instant) heard.is_of_pair = is_of_pair(heard, instant, pair);
  for (const auto& turn : turns) take_turn(pair, turn);
  if (pair.open == 0) pairs_.erase(names);
}

void EpisodeMerge::take_turn(PairState& pair, std::span<HeardEvent* const> turn) {
  for (const HeardEvent* heard : turn) note(pair, *heard);
  if (!pair.is_told) {
    // One who begins to watch a shard finds it open there in the instant in which it begins.
    const HeardEvent* first = chosen(turn, EventKind::began);
    if (first == nullptr) first = chosen(turn, EventKind::open);
    if (pair.open == 0 || first == nullptr) return;
    begin(pair, *first);
  }
  if (pair.is_told_contained && pair.contained == 0) {
    if (const HeardEvent* emerged = chosen(turn, EventKind::emerged)) tell(pair, emerged->event);
    pair.is_told_contained = false;
  }
  if (pair.open == 0) {
    tell(pair, chosen(turn, EventKind::ended)->event);
    pair.is_told = false;
    --told_count_;
  } else if (pair.contained != 0 && !pair.is_told_contained) {
    if (const HeardEvent* contained = chosen(turn, EventKind::contained)) {
      tell(pair, contained->event);
      pair.is_told_contained = true;
    }
  }
}

bool EpisodeMerge::is_owner(const HeardEvent& heard) const {
  const Vec3& point = heard.event.point;
  return map_.owner_of({point.x(), point.y(), point.z()}) == heard.shard;
}

/// How much an event says of the pair: more than that a shard has forgotten it, and most of all by the shard with its point.
int EpisodeMerge::rank(const HeardEvent& heard) const {
  return (heard.event.reason != EndReason::removed ? 2 : 0) + (is_owner(heard) ? 1 : 0);
}

const EpisodeMerge::HeardEvent* EpisodeMerge::chosen(std::span<HeardEvent* const> turn, EventKind kind) const {
  const HeardEvent* found = nullptr;
  for (const HeardEvent* heard : turn) {
    if (heard->event.kind != kind) continue;
    if (found == nullptr || rank(*heard) > rank(*found)) found = heard;
  }
  return found;
}

void EpisodeMerge::begin(PairState& pair, const HeardEvent& heard) {
  pair.is_told = true;
  pair.began = heard.event.began.count() != 0 ? heard.event.began : heard.at;
  pair.episode = sequence_ + 1;
  ++told_count_;
  pair.is_told_contained = heard.event.kind == EventKind::open && heard.event.contained != Containment::none;
  tell(pair, heard.event);
}

void EpisodeMerge::tell(PairState& pair, Event event) {
  event.epoch = 0;
  event.sequence = ++sequence_;
  event.episode = pair.episode;
  event.began = pair.began;
  tell_(event);
}

}  // namespace collided::client
