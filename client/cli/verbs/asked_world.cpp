#include "client/cli/verbs/asked_world.hpp"

#include <span>
#include <utility>
#include <variant>

namespace collided::cli {

AskedWorld::AskedWorld(Session& session, const Globals& globals) {
  if (globals.shards.empty()) client_ = &session.client(globals);
  else shards_ = &session.sharded(globals);
}

Result<Answers> AskedWorld::ask(const Questions& questions, const AskOptions& options) {
  if (client_ != nullptr) return cli::ask(*client_, questions, options);
  return std::visit([&](const auto& list) { return shards_->ask(std::span(list), options); }, questions);
}

std::future<Result<Answers>> AskedWorld::ask_async(Questions questions, const AskOptions& options) {
  if (client_ != nullptr) return cli::ask_async(*client_, std::move(questions), options);
  return std::async(std::launch::async,
                    [this, questions = std::move(questions), options] { return ask(questions, options); });
}

Result<ShardedPairAnswer> AskedWorld::pair(const std::string& a, const std::string& b, const PairOptions& options) {
  if (shards_ != nullptr) return shards_->pair(a, b, options);
  Result<PairAnswer> of_one = client_->pair(a, b, options);
  if (!of_one) return of_one.error();
  return ShardedPairAnswer{std::move(*of_one)};
}

Result<ShardedClearanceAnswer> AskedWorld::clearance(const std::string& from, const ClearanceOptions& options) {
  if (shards_ != nullptr) return shards_->clearance(from, options);
  Result<ClearanceAnswer> of_one = client_->clearance(from, options);
  if (!of_one) return of_one.error();
  return ShardedClearanceAnswer{std::move(*of_one)};
}

}  // namespace collided::cli
