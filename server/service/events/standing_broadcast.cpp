#include "server/service/events/standing_broadcast.hpp"

#include "idl/columns.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {

const std::vector<OpenContact>& StandingBroadcast::open() const {
  static const std::vector<OpenContact> kNone;
  return world_.fences() != nullptr ? world_.fences()->inside() : kNone;
}

void StandingBroadcast::publish(FunctionRef<bool(ObjectId)> is_merged) {
  if (world_.fences() == nullptr) return;
  const SnapshotRing::Lease state = world_.newest();
  const Stamp stamp{.version = state->version, .world_time_ns = state->world_time_ns};
  publish_events(stamp, is_merged);
  publish_state(stamp);
}

/// Frames go before shards, as for contacts.
void StandingBroadcast::publish_events(const Stamp& stamp, FunctionRef<bool(ObjectId)> is_merged) {
  wire::clear(events_);
  const auto send = [&] {
    if (events_.size() == 0) return;
    put_names(events_, [&](ObjectId id) { return book_.name(id); });
    event_writer_.write_standing_events(events_, stamp);
    wire::clear(events_);
  };
  const std::vector<Event>& events = world_.fences()->events();
  for (const Event& event : events) {
    const std::uint64_t hash = wire_contract::contact_hash(event.of.a, event.of.b, event.of.episode);
    hash_ += event.kind == EventKind::began ? hash : -hash;
    changed_.mark(event.of);
    if (event.kind == EventKind::began) book_.note(event.of, world_);
  }
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Event& event = events[i];
    const Event* const next = event.joins_next ? &events[++i] : nullptr;
    const bool is_of_merged =
        is_merged(event.of.a) || is_merged(event.of.b) || (next != nullptr && is_merged(next->of.a));
    events_.add(event, next, book_, is_of_merged);
    Event noted = next != nullptr && next->kind == EventKind::began ? *next : event;
    // A crossing lasts from entry to exit.
    if (event.kind == EventKind::began && next != nullptr) noted.bracket_high_s = next->bracket_high_s;
    recent_.note(noted, stamp.world_time_ns, book_.name(noted.of.a), book_.name(noted.of.b));
    if (events_.size() == wire_contract::kMaxEventsPerFrame) send();
  }
  send();
  for (const Event& event : events) {
    if (event.kind == EventKind::ended) book_.forget(event.of);
  }
}

void StandingBroadcast::publish_state(const Stamp& stamp) {
  const std::vector<OpenContact>& holding = open();
  changed_.take(holding, [&](std::uint8_t shard, const std::vector<std::uint32_t>& numbers) {
    wire::clear(state_);
    state_.shard = shard;
    for (const std::uint32_t i : numbers) state_.add(holding[i], book_);
    put_names(state_, [&](ObjectId id) { return book_.name(id); });
    // DDS delivers no larger message. Names may be left out, held pairs may not.
    constexpr std::size_t kRoom = wire_contract::kMaxMessageBytes - 4'096;
    if (state_.bytes() > kRoom) {
      state_.named_ids.clear();
      state_.names.clear();
    }
    if (state_.bytes() > kRoom)
      return notice_(
          "standing questions hold for more objects than their topic carries; who joins now will not learn all");
    event_writer_.write_standing_state(state_, stamp, world_.fences()->last_sequence());
  });
}

void StandingBroadcast::publish_sum(wire_contract::ServerState state) {
  const Fences* const fences = world_.fences();
  if (fences == nullptr && !event_writer_.standing_wanted()) return;
  const SnapshotRing::Lease newest = world_.newest();
  StandingStateColumns sum;
  sum.shard = wire_contract::kStandingSum;
  sum.state = state;
  sum.count = static_cast<std::uint32_t>(open().size());
  sum.hash = hash_;
  event_writer_.write_standing_state(sum, {.version = newest->version, .world_time_ns = newest->world_time_ns},
                                     fences != nullptr ? fences->last_sequence() : 0);
}

}  // namespace collided::engine::service
