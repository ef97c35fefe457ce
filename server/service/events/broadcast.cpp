#include "server/service/events/broadcast.hpp"

#include "idl/columns.hpp"

namespace collided::engine::service {

void Broadcast::publish(FunctionRef<bool(ObjectId)> is_merged) {
  const SnapshotRing::Lease state = world_.newest();
  const Stamp stamp{.version = state->version, .world_time_ns = state->world_time_ns};
  publish_events(stamp, state->settled_ns, is_merged);
  publish_contacts(stamp);
}

/// Frames go before shards: a subscriber that joins between the two gets an event twice rather than never.
void Broadcast::publish_events(const Stamp& stamp, std::int64_t settled_ns, FunctionRef<bool(ObjectId)> is_merged) {
  const auto name_of = [&](ObjectId id) { return names_.name(id); };
  // Of the frames of one step only the last one has all events up to that time.
  Stamp last = stamp;
  last.settled_ns = settled_ns;
  const auto send = [&](EventColumns& frame, bool persisted, bool is_last = false) {
    if (frame.size() == 0) return;
    put_names(frame, name_of);
    if (persisted) event_writer_.write_persisted(frame, stamp);
    else event_writer_.write_events(frame, is_last ? last : stamp);
    wire::clear(frame);
  };
  wire::clear(events_);
  wire::clear(persisted_);
  for (const Event& event : world_.events()) {
    const bool persisted = event.kind == EventKind::persisted;
    if (!persisted) {
      const std::uint64_t hash = wire_contract::contact_hash(event.of.a, event.of.b, event.of.episode);
      // A sum, so that an ended contact can be subtracted again.
      if (event.kind == EventKind::began) contact_hash_ += hash;
      if (event.kind == EventKind::ended) contact_hash_ -= hash;
      changed_.mark(event.of);
      if (event.kind == EventKind::began) names_.note(event.of, world_);
    }
    EventColumns& frame = persisted ? persisted_ : events_;
    frame.add(event, names_, is_merged(event.of.a) || is_merged(event.of.b));
    if (!persisted) recent_.note(event, stamp.world_time_ns, names_.name(event.of.a), names_.name(event.of.b));
    if (frame.size() == wire_contract::kMaxEventsPerFrame) send(frame, persisted);
  }
  send(events_, false, true);
  send(persisted_, true);
  for (const Event& event : world_.events()) {
    if (event.kind == EventKind::ended) names_.forget(event.of);
  }
}

void Broadcast::publish_contacts(const Stamp& stamp) {
  const std::vector<OpenContact>& holding = world_.contacts();
  changed_.take(holding, [&](std::uint8_t shard, const std::vector<std::uint32_t>& numbers) {
    wire::clear(contacts_);
    contacts_.shard = shard;
    for (const std::uint32_t i : numbers) contacts_.add(holding[i], names_);
    put_names(contacts_, [&](ObjectId id) { return names_.name(id); });
    // DDS delivers no larger message. Names may be left out, contacts may not.
    constexpr std::size_t kRoom = wire_contract::kMaxMessageBytes - 4'096;
    if (contacts_.bytes() > kRoom) {
      contacts_.named_ids.clear();
      contacts_.names.clear();
    }
    if (contacts_.bytes() > kRoom)
      return notice_("more contacts hold than the contact topic carries; who joins now will not learn them all");
    event_writer_.write_contacts(contacts_, stamp, world_.last_event_sequence());
  });
}

}  // namespace collided::engine::service
