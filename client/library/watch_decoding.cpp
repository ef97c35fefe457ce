#include "client/library/watch_decoding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collided::client {
namespace {

using std::chrono::nanoseconds;
using wire_contract::kContactNumbers;
using wire_contract::kEventNumbers;
using wire_contract::kEventNumbersBefore;
using wire_contract::ServerState;

// The code n on the wire is n + 1 here: `open` exists only on this side.
constexpr int kFirstKind = static_cast<int>(EventKind::began);

Vec3 vector_at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// The bound of its depth is infinite, and in the normal's place stands why.
Doubt doubt_at(const double* numbers) {
  if (!std::isinf(numbers[7])) return Doubt::none;
  for (const Doubt doubt : {Doubt::cost_limit, Doubt::publisher_lost}) {
    if (numbers[3] == static_cast<double>(doubt)) return doubt;
  }
  return Doubt::numeric;
}

bool fits(const wire::EventFrame& frame) {
  const std::size_t count = frame.kinds._length;
  const auto kinds = dds::view(frame.kinds);
  const auto reasons = dds::view(frame.reasons);
  return frame.reasons._length == count && frame.shards._length == count && frame.a._length == count &&
         frame.b._length == count && frame.a_triangles._length == count && frame.b_triangles._length == count &&
         frame.episodes._length == count && (frame.numbers._length == count * kEventNumbers || frame.numbers._length == count * kEventNumbersBefore) &&
         std::all_of(kinds.begin(), kinds.end(), [](auto k) { return k <= static_cast<int>(wire_contract::EventKind::ended); }) &&
         std::all_of(reasons.begin(), reasons.end(), [](auto r) { return r <= static_cast<int>(EndReason::decided); });
}

bool fits(const wire::ContactShard& shard) {
  const std::size_t count = shard.a._length;
  return shard.b._length == count && shard.a_triangles._length == count && shard.b_triangles._length == count &&
         shard.episodes._length == count && shard.began_ns._length == count &&
         shard.numbers._length == count * kContactNumbers;
}

// What frames and shards have in common. Both begin their numbers with point, normal, depth and its bound.
template <class Message>
Event decode_pair(const Message& message, std::size_t index, std::size_t number_count, const Names& names) {
  const double* const numbers = dds::view(message.numbers).data() + index * number_count;
  Event event;
  event.a_id = dds::view(message.a)[index];
  event.b_id = dds::view(message.b)[index];
  event.a = names.name(event.a_id);
  event.b = names.name(event.b_id);
  event.a_triangle = dds::view(message.a_triangles)[index];
  event.b_triangle = dds::view(message.b_triangles)[index];
  event.epoch = message.epoch;
  event.episode = dds::view(message.episodes)[index];
  event.point = vector_at(numbers);
  event.normal = vector_at(numbers + 3);
  event.depth_m = numbers[6];
  event.depth_error_m = numbers[7];
  event.doubt = doubt_at(numbers);
  if (event.doubt != Doubt::none) event.normal = Vec3::Zero();
  return event;
}

}  // namespace

std::optional<HeardFrame> decode(const wire::EventFrame& frame, Names& names) {
  if (!fits(frame)) {
    return std::nullopt;
  }
  names.learn(dds::view(frame.named_ids), dds::view(frame.names));
  HeardFrame heard{{frame.server, frame.epoch}, frame.first_sequence, {}};
  heard.entries.reserve(frame.kinds._length);
  const std::size_t stride = frame.numbers._length == frame.kinds._length * kEventNumbers ? kEventNumbers : kEventNumbersBefore;
  for (std::size_t i = 0; i < frame.kinds._length; ++i) {
    const double* const numbers = dds::view(frame.numbers).data() + i * stride;
    Event event = decode_pair(frame, i, stride, names);
    event.kind = static_cast<EventKind>(dds::view(frame.kinds)[i] + kFirstKind);
    event.reason = static_cast<EndReason>(dds::view(frame.reasons)[i]);
    event.world_time = nanoseconds(frame.world_time_ns);
    event.bracket_low_s = numbers[8];
    event.bracket_high_s = numbers[9];
    event.relative_velocity = Vec3(numbers[10], numbers[11], numbers[12]);
    event.velocity_error = stride == kEventNumbers ? numbers[13] : std::numeric_limits<double>::infinity();
    heard.entries.push_back({std::move(event), dds::view(frame.shards)[i]});
  }
  return heard;
}

std::optional<HeardShard> decode(const wire::ContactShard& shard, Names& names) {
  if (!fits(shard)) {
    return std::nullopt;
  }
  names.learn(dds::view(shard.named_ids), dds::view(shard.names));
  HeardShard heard{{shard.server, shard.epoch}, shard.shard, shard.as_of_sequence, {}};
  heard.contacts.reserve(shard.a._length);
  for (std::size_t i = 0; i < shard.a._length; ++i) {
    Event contact = decode_pair(shard, i, kContactNumbers, names);
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
