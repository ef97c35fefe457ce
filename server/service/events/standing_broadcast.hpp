#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/geometry/function_ref.hpp"
#include "server/service/events/changed_shards.hpp"
#include "server/service/events/event_writer.hpp"
#include "server/service/events/standing_frames.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Publishes each step's results for standing questions, as Broadcast does for contacts. Independent of DDS and time.
///
/// threads  the one that writes the world
class StandingBroadcast {
 public:
  /// notice  takes a sentence for the log
  StandingBroadcast(World& world, EventWriter& event_writer, std::function<void(const std::string&)> notice)
      : world_(world), event_writer_(event_writer), notice_(std::move(notice)) {}

  /// Marks every shard as changed, as Broadcast does.
  void mark_all() { changed_.mark_all(); }
  /// Publishes the results of the newest step. Call this once a step. Costs nothing until there is a question.
  ///
  /// is_merged  whether poses of an object were merged on the path that the step decided
  void publish(FunctionRef<bool(ObjectId)> is_merged);
  /// Publishes the number and hash of held pairs, for comparison: once there was a question, or while the topic has
  /// readers.
  void publish_sum(wire_contract::ServerState state);

  /// The objects for which a question holds now.
  const std::vector<OpenContact>& open() const;
  /// The newest events, which may be read on any thread.
  const RecentEvents& recent() const { return recent_; }

 private:
  void publish_events(const Stamp& stamp, FunctionRef<bool(ObjectId)> is_merged);
  void publish_state(const Stamp& stamp);

  World& world_;
  EventWriter& event_writer_;
  std::function<void(const std::string&)> notice_;
  StandingBook book_;
  RecentEvents recent_;
  StandingColumns events_;
  StandingStateColumns state_;
  ChangedShards changed_;
  std::uint64_t hash_ = 0;  // sum of contact_hash() in topics.hpp over the held pairs
};

}  // namespace collided::engine::service
