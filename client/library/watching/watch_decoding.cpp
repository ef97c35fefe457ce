#include "client/library/watching/watch_decoding.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "idl/columns.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;
using wire_contract::ServerState;

// A kind's code n on the wire is n + 1 in EventKind, since `open` is not on the wire.
constexpr int kFirstKind = static_cast<int>(EventKind::began);

/// An unknown code of a newer server counts as `numeric`.
Doubt doubt_of(std::uint8_t code) { return codes::is_known<Doubt>(code) ? static_cast<Doubt>(code) : Doubt::numeric; }

bool fits(const wire::EventFrame& frame) {
  return wire::has_rows<wire::EventFrameColumns>(frame, frame.kinds._length) &&
         std::ranges::all_of(dds::view(frame.kinds), codes::is_known<wire_contract::EventKind>) &&
         std::ranges::all_of(dds::view(frame.reasons), codes::is_known<EndReason>);
}

bool fits(const wire::ContactShard& shard) { return wire::has_rows<wire::ContactShardColumns>(shard, shard.a._length); }

bool fits(const wire::StandingFrame& frame) {
  return wire::has_rows<wire::StandingFrameColumns>(frame, frame.kinds._length) &&
         std::ranges::all_of(dds::view(frame.kinds), codes::is_known<StandingEventKind>) &&
         std::ranges::all_of(dds::view(frame.forms), codes::is_known<StandingForm>) &&
         std::ranges::all_of(dds::view(frame.reasons), codes::is_known<EndReason>);
}

bool fits(const wire::StandingShard& shard) {
  return wire::has_rows<wire::StandingShardColumns>(shard, shard.forms._length) &&
         std::ranges::all_of(dds::view(shard.kinds), codes::is_known<StandingEventKind>) &&
         std::ranges::all_of(dds::view(shard.forms), codes::is_known<StandingForm>);
}

void take_doubt(std::uint8_t doubts, Event& event) {
  event.doubt = doubt_of(static_cast<std::uint8_t>(doubts & ~wire_contract::kDoubtPosesMerged));
  event.poses_merged = (doubts & wire_contract::kDoubtPosesMerged) != 0;
}

bool is_settled(std::uint8_t state) {
  return state == static_cast<std::uint8_t>(ServerState::ready) ||
         state == static_cast<std::uint8_t>(ServerState::stopping);
}

// The common part of frames and shards.
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
  take_doubt(dds::view(message.doubts)[index], event);
  return event;
}

// The common part of frames and shards of standing questions.
template <class Message>
StandingNews decode_row(const Message& message, std::size_t index, EventKind kind, std::uint64_t object,
                        const Names& names) {
  StandingNews news;
  wire::take_row(message, index, static_cast<Event&>(news));
  wire::take_row(message, index, news.reported);
  news.kind = kind;
  news.a_id = object;
  news.b_id = dds::view(message.standings)[index];
  news.a = names.name(news.a_id);
  news.b = names.name(news.b_id);
  if (news.reported.form == StandingForm::bands) news.reported.other = names.name(dds::view(message.others)[index]);
  news.epoch = message.epoch;
  news.world_time = nanoseconds(message.world_time_ns);
  news.detects = dds::view(message.detects)[index];
  take_doubt(dds::view(message.doubts)[index], news);
  return news;
}

/// Reads the members that only events of bands have.
void take_motion(const wire::StandingFrame& frame, std::size_t index, StandingEvent& reported) {
  if (reported.form != StandingForm::bands) return;
  wire::take(frame.closings, index, reported.closing_mps);
  wire::take(frame.closing_errors, index, reported.closing_error_mps);
  StandingEvent::Forecast in;
  wire::take(frame.contact_lows, index, in.low_s);
  wire::take(frame.contact_highs, index, in.high_s);
  if (std::isfinite(in.high_s)) reported.contact_in = {std::max(0.0, in.low_s), in.high_s};
}

/// Adds the parts of an event to the entries; false if it is invalid.
bool take_event(const wire::StandingFrame& frame, std::size_t index, const Names& names,
                std::vector<HeardFrameOf<StandingNews>::Entry>& entries) {
  using enum StandingEventKind;
  const auto kind = static_cast<StandingEventKind>(dds::view(frame.kinds)[index]);
  const std::uint64_t object = dds::view(frame.objects)[index], other = dds::view(frame.others)[index];
  const auto add = [&](EventKind part, std::uint64_t id) -> StandingNews& {
    StandingNews& news = entries.emplace_back(decode_row(frame, index, part, id, names)).event;
    entries.back().shard = wire_contract::contact_shard(news.a_id, news.b_id);
    return news;
  };
  const auto join = [&](StandingNews& news) {
    news.is_silent = true;
    entries.back().joins_next = true;
  };
  switch (kind) {
    case inside:
    case within:
    case is: return false;
    case enter:
    case approach:
    case near:
    case contact: take_motion(frame, index, add(EventKind::began, object).reported); break;
    case exit:
    case leave: add(EventKind::ended, object); break;
    case cross: {
      join(add(EventKind::began, object));
      StandingNews& left = add(EventKind::ended, object);
      left.bracket_low_s = left.reported.left_low_s;
      left.bracket_high_s = left.reported.left_high_s;
      break;
    }
    case changed: {
      if (other != 0) {
        StandingNews& before = add(EventKind::ended, other);
        before.reported = {};
        before.reported.form = StandingForm::nearest;
        before.doubt = Doubt::none;
        if (object != 0) join(before);
      }
      if (object == 0) return other != 0;
      StandingNews& now = add(EventKind::began, object);
      now.episode = frame.first_sequence + index;
      if (other != 0) now.reported.other = names.name(other);
      return true;
    }
  }
  return object != 0;
}

}  // namespace

std::optional<HeardFrame> decode(const wire::EventFrame& frame, Names& names) {
  if (!fits(frame)) { return std::nullopt; }
  names.learn(dds::view(frame.named_ids), dds::view(frame.names));
  HeardFrame heard{
      {frame.server, frame.epoch}, frame.first_sequence, {}, frame.version == 0, nanoseconds(frame.settled_ns)};
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
  return {.from = {status.server, status.epoch},
          .last_event_sequence = status.last_event_sequence,
          .contact_count = status.contact_count,
          .contact_hash = status.contact_hash,
          .world_time = nanoseconds(status.world_time_ns),
          .settled = is_settled(status.state),
          // While a step lasts, the status from before it is repeated.
          .settled_to = nanoseconds(wire::busy_ns(status) > 0 ? 0 : status.settled_ns),
          .heir_of = status.heir_of,
          .told_from = status.told_from};
}

std::optional<HeardFrameOf<StandingNews>> decode(const wire::StandingFrame& frame, Names& names) {
  if (!fits(frame)) { return std::nullopt; }
  names.learn(dds::view(frame.named_ids), dds::view(frame.names));
  HeardFrameOf<StandingNews> heard{{frame.server, frame.epoch}, frame.first_sequence, {}, frame.version == 0};
  heard.entries.reserve(frame.kinds._length);
  for (std::size_t i = 0; i < frame.kinds._length; ++i) {
    if (!take_event(frame, i, names, heard.entries)) { return std::nullopt; }
  }
  return heard;
}

std::optional<HeardShardOf<StandingNews>> decode(const wire::StandingShard& shard, Names& names) {
  if (!fits(shard)) { return std::nullopt; }
  names.learn(dds::view(shard.named_ids), dds::view(shard.names));
  HeardShardOf<StandingNews> heard{{shard.server, shard.epoch}, shard.shard, shard.as_of_sequence, {}};
  heard.contacts.reserve(shard.forms._length);
  for (std::size_t i = 0; i < shard.forms._length; ++i) {
    StandingNews& holds =
        heard.contacts.emplace_back(decode_row(shard, i, EventKind::open, dds::view(shard.objects)[i], names));
    holds.began = holds.world_time = nanoseconds(dds::view(shard.began_ns)[i]);
  }
  return heard;
}

std::optional<HeardBookmark> bookmark_in(const wire::StandingShard& shard) {
  if (shard.shard != wire_contract::kStandingSum) { return std::nullopt; }
  return HeardBookmark{.from = {shard.server, shard.epoch},
                       .last_event_sequence = shard.as_of_sequence,
                       .contact_count = shard.count,
                       .contact_hash = shard.hash,
                       .world_time = nanoseconds(shard.world_time_ns),
                       .settled = is_settled(shard.state)};
}

}  // namespace collided::client
