#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/geometry/function_ref.hpp"
#include "server/service/events/changed_shards.hpp"
#include "server/service/events/event_writer.hpp"
#include "server/service/events/frames.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Publishes the results of each step: every event once, in frames without a gap, then the shards of the contact state
/// that changed. Independent of DDS and time.
///
/// threads  the one that writes the world
class Broadcast {
 public:
  /// notice  takes a sentence for the log
  Broadcast(World& world, EventWriter& event_writer, std::function<void(const std::string&)> notice)
      : world_(world), event_writer_(event_writer), notice_(std::move(notice)) {}

  /// Marks every shard as changed, even the empty ones: a subscriber that waits for all shards need not guess.
  void mark_all() { changed_.mark_all(); }
  /// Publishes the results of the newest step. Call this once a step.
  ///
  /// is_merged  whether poses of an object were merged on the path that the step decided
  void publish(FunctionRef<bool(ObjectId)> is_merged);

  /// Sum of contact_hash() in topics.hpp over the contacts that hold.
  std::uint64_t contact_hash() const { return contact_hash_; }
  /// The newest events, which may be read on any thread.
  const RecentEvents& recent() const { return recent_; }

 private:
  void publish_events(const Stamp& stamp, std::int64_t settled_ns, FunctionRef<bool(ObjectId)> is_merged);
  void publish_contacts(const Stamp& stamp);

  World& world_;
  EventWriter& event_writer_;
  std::function<void(const std::string&)> notice_;
  NameBook names_;
  RecentEvents recent_;
  EventColumns events_;
  EventColumns persisted_;
  ChangedShards changed_;
  ContactColumns contacts_;
  std::uint64_t contact_hash_ = 0;
};

}  // namespace collided::engine::service
