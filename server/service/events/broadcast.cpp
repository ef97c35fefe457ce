#include "server/service/events/broadcast.hpp"

#include <algorithm>
#include <utility>

#include "idl/columns.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {

Broadcast::Broadcast(World& world, EventWriter& event_writer, std::function<void(const std::string&)> notice,
                     BroadcastOf subject)
    : world_(world),
      event_writer_(event_writer),
      subject_(subject),
      notice_(std::move(notice)),
      dirty_shards_(wire_contract::kContactShards, 0),
      of_shard_(wire_contract::kContactShards) {}

void Broadcast::mark_all() { dirty_shards_.assign(wire_contract::kContactShards, 1); }

const std::vector<Event>& Broadcast::events() const {
  return subject_ == BroadcastOf::contacts ? world_.events() : world_.fences()->events();
}

const std::vector<OpenContact>& Broadcast::open() const {
  static const std::vector<OpenContact> kNone;
  if (subject_ == BroadcastOf::contacts) return world_.contacts();
  return world_.fences() != nullptr ? world_.fences()->inside() : kNone;
}

std::uint64_t Broadcast::last_sequence() const {
  if (subject_ == BroadcastOf::contacts) return world_.last_event_sequence();
  return world_.fences() != nullptr ? world_.fences()->last_sequence() : 0;
}

void Broadcast::publish(FunctionRef<bool(ObjectId)> is_merged) {
  if (subject_ == BroadcastOf::fences && world_.fences() == nullptr) return;
  const SnapshotRing::Lease state = world_.newest();
  const Stamp stamp{.version = state->version, .world_time_ns = state->world_time_ns};
  publish_events(stamp, is_merged);
  publish_contacts(stamp);
}

/// Frames go before shards: a subscriber that joins between the two gets an event twice rather than never.
void Broadcast::publish_events(const Stamp& stamp, FunctionRef<bool(ObjectId)> is_merged) {
  const auto name_of = [&](ObjectId id) { return names_.name(id); };
  const auto send = [&](EventColumns& frame, bool persisted) {
    if (frame.size() == 0) return;
    put_names(frame, name_of);
    if (persisted) {
      event_writer_.write_persisted(frame, stamp);
    } else if (subject_ == BroadcastOf::fences) {
      event_writer_.write_fence_events(frame, stamp);
    } else {
      event_writer_.write_events(frame, stamp);
    }
    wire::clear(frame);
  };
  wire::clear(events_);
  wire::clear(persisted_);
  for (const Event& event : events()) {
    const bool persisted = event.kind == EventKind::persisted;
    if (!persisted) {
      const std::uint64_t hash = wire_contract::contact_hash(event.of.a, event.of.b, event.of.episode);
      // A sum, so that an ended contact can be taken out again.
      if (event.kind == EventKind::began) contact_hash_ += hash;
      if (event.kind == EventKind::ended) contact_hash_ -= hash;
      dirty_shards_[wire_contract::contact_shard(event.of.a, event.of.b)] = 1;
      if (event.kind == EventKind::began) names_.note(event.of, world_);
    }
    EventColumns& frame = persisted ? persisted_ : events_;
    frame.add(event, names_, is_merged(event.of.a) || is_merged(event.of.b));
    if (!persisted) recent_.note(event, stamp.world_time_ns, names_.name(event.of.a), names_.name(event.of.b));
    if (frame.size() == wire_contract::kMaxEventsPerFrame) send(frame, persisted);
  }
  send(events_, false);
  send(persisted_, true);
  for (const Event& event : events()) {
    if (event.kind == EventKind::ended) names_.forget(event.of);
  }
}

void Broadcast::publish_contacts(const Stamp& stamp) {
  if (std::find(dirty_shards_.begin(), dirty_shards_.end(), 1) == dirty_shards_.end()) return;
  const std::vector<OpenContact>& holding = open();
  for (std::vector<std::uint32_t>& numbers : of_shard_) numbers.clear();
  for (std::uint32_t i = 0; i < holding.size(); ++i) {
    const std::uint32_t shard = wire_contract::contact_shard(holding[i].a, holding[i].b);
    if (dirty_shards_[shard] != 0) of_shard_[shard].push_back(i);
  }
  const auto name_of = [&](ObjectId id) { return names_.name(id); };
  for (std::uint32_t shard = 0; shard < dirty_shards_.size(); ++shard) {
    if (dirty_shards_[shard] == 0) continue;
    dirty_shards_[shard] = 0;
    wire::clear(contacts_);
    contacts_.shard = static_cast<std::uint8_t>(shard);
    for (const std::uint32_t i : of_shard_[shard]) contacts_.add(holding[i], names_);
    put_names(contacts_, name_of);
    // DDS delivers no larger message. Names can be done without, contacts cannot.
    constexpr std::size_t kRoom = wire_contract::kMaxMessageBytes - 4'096;
    if (contacts_.bytes() > kRoom) {
      contacts_.named_ids.clear();
      contacts_.names.clear();
    }
    if (contacts_.bytes() > kRoom) {
      notice_(subject_ == BroadcastOf::fences
                  ? "more objects are in fences than the topic of that carries; who joins now will not learn them all"
                  : "more contacts hold than the contact topic carries; who joins now will not learn them all");
      continue;
    }
    if (subject_ == BroadcastOf::fences) event_writer_.write_fence_state(contacts_, stamp, last_sequence());
    else event_writer_.write_contacts(contacts_, stamp, last_sequence());
  }
}

}  // namespace collided::engine::service
