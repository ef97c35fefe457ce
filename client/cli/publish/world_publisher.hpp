#pragma once

#include <chrono>
#include <string>
#include <variant>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/session.hpp"

namespace collided::cli {

/// A publisher of one server, or with --shards of a world on several. The session must outlive it. One thread.
class WorldPublisher {
 public:
  using Object = Publisher::Object;

  /// Connects; throws Failure.
  WorldPublisher(Session& session, const Globals& globals, const std::string& publisher_name);

  Result<Object> add(const ObjectOptions& options);
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  Result<void> flush(std::chrono::nanoseconds source_time);
  /// As Publisher::stream. Throws Failure with --shards, where each flush says of every object where it is.
  void stream();
  Result<void> keep_alive();
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// For what does more than these: without --shards only.
  Publisher& of_one_server() { return std::get<Publisher>(publisher_); }

 private:
  std::variant<Publisher, ShardedPublisher> publisher_;
};

}  // namespace collided::cli
