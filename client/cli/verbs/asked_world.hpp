#pragma once

#include <future>
#include <string>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/input/question.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// Who answers the questions of a verb: one server, or with --shards all those of a shard map. Connects at once; throws
/// Failure. The session must outlive it.
class AskedWorld {
 public:
  AskedWorld(Session& session, const Globals& globals);

  Result<Answers> ask(const Questions& questions, const AskOptions& options);
  /// The same on another thread.
  std::future<Result<Answers>> ask_async(Questions questions, const AskOptions& options);
  /// Of one server with nothing left open.
  Result<ShardedPairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options);
  Result<ShardedClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options);

 private:
  Client* client_ = nullptr;
  ShardedClient* shards_ = nullptr;  // in its place, with --shards
};

}  // namespace collided::cli
