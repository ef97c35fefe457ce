#pragma once

#include <chrono>
#include <string>
#include <variant>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/session.hpp"

namespace collided::cli {

/// A publisher to one server, or with --shards to several. The session must outlive it. One thread.
class WorldPublisher {
 public:
  using Object = Publisher::Object;

  /// Connects; throws Failure.
  WorldPublisher(Session& session, const Globals& globals, const std::string& publisher_name,
                 const PublishOptions& options = {});

  Result<Object> add(const ObjectOptions& options);
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  Result<FlushReport> flush(std::chrono::nanoseconds source_time);
  /// See Publisher::stream. Throws Failure with --shards, where each flush has the pose of every object.
  void stream();
  Result<void> keep_alive(std::chrono::nanoseconds source_time);
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// Waits until every object added so far is in the world; returns why one is not.
  Result<void> wait_entered(std::chrono::nanoseconds timeout);
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);
  /// For further calls: only without --shards.
  Publisher& of_one_server() { return std::get<Publisher>(publisher_); }

 private:
  std::variant<Publisher, ShardedPublisher> publisher_;
};

}  // namespace collided::cli
