#pragma once

#include <optional>

#include "client/library/connection/names.hpp"
#include "client/library/watching/standing_news.hpp"
#include "client/library/watching/watch_state.hpp"
#include "idl/dds.hpp"
#include "idl/recording/recorded_topics.hpp"

namespace collided::client {

/// The message types and recorded topics of a kind of news.
template <class News>
struct WireOf;
template <>
struct WireOf<Event> {
  using Frame = wire::EventFrame;
  using Shard = wire::ContactShard;
  static constexpr const wire_contract::TopicQos& kFrames = wire_contract::kEventTopic;
  static constexpr const wire_contract::TopicQos& kShards = wire_contract::kContactTopic;
  static constexpr auto kRecordedFrames = recording::Recorded::event;
  static constexpr auto kRecordedShards = recording::Recorded::contact;
};
template <>
struct WireOf<StandingNews> {
  using Frame = wire::StandingFrame;
  using Shard = wire::StandingShard;
  static constexpr const wire_contract::TopicQos& kFrames = wire_contract::kStandingEventTopic;
  static constexpr const wire_contract::TopicQos& kShards = wire_contract::kStandingStateTopic;
  static constexpr auto kRecordedFrames = recording::Recorded::standing_event;
  static constexpr auto kRecordedShards = recording::Recorded::standing_state;
};

/// Decodes a message; nothing if its columns differ in length or a code is unknown. It then counts as lost.
std::optional<HeardFrame> decode(const wire::EventFrame& frame, Names& names);
std::optional<HeardShard> decode(const wire::ContactShard& shard, Names& names);
HeardBookmark decode(const wire::Status& status);
std::optional<HeardFrameOf<StandingNews>> decode(const wire::StandingFrame& frame, Names& names);
std::optional<HeardShardOf<StandingNews>> decode(const wire::StandingShard& shard, Names& names);
/// The bookmark in a shard of standing questions that is the sum of the others.
std::optional<HeardBookmark> bookmark_in(const wire::StandingShard& shard);
inline std::optional<HeardBookmark> bookmark_in(const wire::ContactShard&) { return std::nullopt; }

}  // namespace collided::client
