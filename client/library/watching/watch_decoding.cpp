#include "client/library/watching/watch_decoding.hpp"

#include <algorithm>

#include "idl/columns.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;
using wire_contract::ServerState;

// A kind's code n on the wire is n + 1 in EventKind, whose `open` is not on the wire.
constexpr int kFirstKind = static_cast<int>(EventKind::began);

/// A code that this library does not know yet counts as `numeric`.
Doubt doubt_of(std::uint8_t code) { return codes::is_known<Doubt>(code) ? static_cast<Doubt>(code) : Doubt::numeric; }

bool fits(const wire::EventFrame& frame) {
  return wire::has_rows<wire::EventFrameColumns>(frame, frame.kinds._length) &&
         std::ranges::all_of(dds::view(frame.kinds), codes::is_known<wire_contract::EventKind>) &&
         std::ranges::all_of(dds::view(frame.reasons), codes::is_known<EndReason>);
}

bool fits(const wire::ContactShard& shard) { return wire::has_rows<wire::ContactShardColumns>(shard, shard.a._length); }

// What frames and shards have in common.
template <class Message>
Event decode_pair(const Message& message, std::size_t index, const Names& names) {
  Event event;
  wire::take_row(message, index, event);
  event.a_id = dds::view(message.a)[index];
  event.b_id = dds::view(message.b)[index];
  event.a = names.name(event.a_id);
  event.b = names.name(event.b_id);
  if (event.a_triangle == wire_contract::kTriangleWithin) event.contained = Containment::a_in_b;
  if (event.b_triangle == wire_contract::kTriangleWithin) event.contained = Containment::b_in_a;
  if (event.contained != Containment::none)
    (event.contained == Containment::a_in_b ? event.a_triangle : event.b_triangle) = kNoTriangle;
  event.epoch = message.epoch;
  const std::uint8_t doubts = dds::view(message.doubts)[index];
  event.doubt = doubt_of(static_cast<std::uint8_t>(doubts & ~wire_contract::kDoubtPosesMerged));
  event.poses_merged = (doubts & wire_contract::kDoubtPosesMerged) != 0;
  return event;
}

}  // namespace

std::optional<HeardFrame> decode(const wire::EventFrame& frame, Names& names) {
  if (!fits(frame)) { return std::nullopt; }
  names.learn(dds::view(frame.named_ids), dds::view(frame.names));
  HeardFrame heard{{frame.server, frame.epoch}, frame.first_sequence, {}, frame.version == 0};
  heard.entries.reserve(frame.kinds._length);
  for (std::size_t i = 0; i < frame.kinds._length; ++i) {
    Event event = decode_pair(frame, i, names);
    event.kind = static_cast<EventKind>(dds::view(frame.kinds)[i] + kFirstKind);
    event.world_time = nanoseconds(frame.world_time_ns);
    wire::take(frame.velocities, i, event.relative_velocity);
    heard.entries.push_back({std::move(event), dds::view(frame.shards)[i]});
  }
  return heard;
}

std::optional<HeardShard> decode(const wire::ContactShard& shard, Names& names) {
  if (!fits(shard)) { return std::nullopt; }
  names.learn(dds::view(shard.named_ids), dds::view(shard.names));
  HeardShard heard{{shard.server, shard.epoch}, shard.shard, shard.as_of_sequence, {}};
  heard.contacts.reserve(shard.a._length);
  for (std::size_t i = 0; i < shard.a._length; ++i) {
    Event contact = decode_pair(shard, i, names);
    contact.kind = EventKind::open;
    contact.began = contact.world_time = nanoseconds(dds::view(shard.began_ns)[i]);
    heard.contacts.push_back(std::move(contact));
  }
  return heard;
}

HeardBookmark decode(const wire::Status& status) {
  const auto state = static_cast<ServerState>(status.state);
  return {.from = {status.server, status.epoch},
          .last_event_sequence = status.last_event_sequence,
          .contact_count = status.contact_count,
          .contact_hash = status.contact_hash,
          .world_time = nanoseconds(status.world_time_ns),
          .settled = state == ServerState::ready || state == ServerState::stopping};
}

}  // namespace collided::client
