#pragma once

#include <future>
#include <string>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/input/question.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {

/// Asks a verb's questions: one server, or with --shards all those of a shard map. Connects at once; throws Failure.
/// The session must outlive it.
class AskedWorld {
 public:
  AskedWorld(Session& session, const Globals& globals);

  Result<Answers> ask(const Questions& questions, const AskOptions& options);
  /// The same on another thread.
  std::future<Result<Answers>> ask_async(Questions questions, const AskOptions& options);
  /// For one server, with no options left open.
  Result<ShardedPairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options);
  Result<ShardedClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options);

 private:
  Client* client_ = nullptr;
  ShardedClient* shards_ = nullptr;  // instead of it, with --shards
};

}  // namespace collided::cli
