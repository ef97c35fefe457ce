#include <fmt/format.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "idl/shards/shard_split.hpp"
#include "server/fleet/shards/shard_commands.hpp"
#include "server/fleet/shards/shard_watchers.hpp"

// Which map of shards this server is of, and which one comes after it.
namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

/// What holds cannot be taken back.
int step_of(shards::SuccessionPhase phase) {
  switch (phase) {
    case shards::SuccessionPhase::joining:
    case shards::SuccessionPhase::withdrawn: return 0;
    case shards::SuccessionPhase::in_force: return 1;
    case shards::SuccessionPhase::done: return 2;
  }
  return 0;
}

class ShardCommands : public CommandFamily {
 public:
  ShardCommands(CommandContext& context, FleetCommands fleet) : CommandFamily(context), fleet_(std::move(fleet)) {}
  std::vector<BoundCommand> commands() override;

 private:
  json shard();
  json hand_over(const Arguments& arguments) const;
  json watching(const CommandAsk& ask, const Arguments& arguments);
  json succession(const CommandAsk& ask, const Arguments& arguments);
  void succeed(shards::MapSuccession next);

  const FleetCommands fleet_;
  ShardWatchers shard_watchers_;
  std::mutex succession_mutex_;
  std::optional<shards::MapSuccession> succession_;  // none: no other map than that of the start is known
};

}  // namespace

std::unique_ptr<CommandFamily> shard_commands(CommandContext& context, FleetCommands fleet) {
  return std::make_unique<ShardCommands>(context, std::move(fleet));
}

std::vector<BoundCommand> ShardCommands::commands() {
  return {on_asking_thread(names::kShard, this, &ShardCommands::shard),
          on_world_thread(names::kWatching, this, &ShardCommands::watching),
          on_world_thread(names::kSuccession, this, &ShardCommands::succession),
          on_asking_thread(names::kHandOver, this, &ShardCommands::hand_over)};
}

json ShardCommands::hand_over(const Arguments& arguments) const {
  return {{"to", fleet_.hand_over(arguments.text("to"))}};
}

json ShardCommands::watching(const CommandAsk& ask, const Arguments& arguments) {
  shard_watchers_.heard(ask.client, arguments.whole("watch"), arguments.text("map"), steady_ns());
  return json::object();
}

json ShardCommands::shard() {
  if (with_.shard == nullptr) throw BadCommand("this server is no shard: it holds all of its world");
  json answer{{"name", with_.shard->name},
              {"map", shards::fingerprint_text(fleet_.shard_map)},
              {"epoch", with_.loop.world().newest()->epoch},
              {"replaced_within_ns", fleet_.replaced_within_ns}};
  const std::lock_guard lock(succession_mutex_);
  if (!succession_) return answer;
  answer["succession"] = json::parse(shards::succession_text(*succession_));
  const ShardWatchers::WatcherCounts counts =
      shard_watchers_.counts(shards::fingerprint_text(succession_->next.fingerprint()), steady_ns());
  answer["watches"] = counts.all;
  answer["watches_behind"] = counts.behind;
  return answer;
}

/// Notes a phase, which must come after the one that is known, of a map that comes after the one that holds.
void ShardCommands::succeed(shards::MapSuccession next) {
  const std::lock_guard lock(succession_mutex_);
  const std::uint64_t own = fleet_.shard_map;
  std::uint64_t holds = own;
  if (succession_) {
    if (next.revision <= succession_->revision)
      throw BadCommand(fmt::format("revision {} is not higher than {}, which is known here. Nothing was done",
                                   next.revision, succession_->revision));
    if (succession_->phase != shards::SuccessionPhase::withdrawn) holds = succession_->next.fingerprint();
    const bool is_same = next.from == succession_->from && next.next.fingerprint() == succession_->next.fingerprint();
    if (succession_->phase == shards::SuccessionPhase::joining && !is_same)
      throw BadCommand(fmt::format("a split to map {} is under way. Nothing was done",
                                   shards::fingerprint_text(succession_->next.fingerprint())),
                       "finish that one, or take it back: collide fleet split ... --undo");
    if (is_same) holds = next.from;
    if (is_same && step_of(next.phase) < step_of(succession_->phase))
      throw BadCommand(fmt::format("'{}' does not come after '{}'. Nothing was done", name_of(next.phase),
                                   name_of(succession_->phase)));
  }
  if (next.from != holds && next.from != own && next.next.fingerprint() != own)
    throw BadCommand(fmt::format("it begins with map {}, and this server is of map {}. Nothing was done",
                                 shards::fingerprint_text(next.from), shards::fingerprint_text(holds)));
  succession_ = std::move(next);
}

json ShardCommands::succession(const CommandAsk& ask, const Arguments&) {
  if (with_.shard == nullptr) throw BadCommand("this server is no shard: it holds all of its world. Nothing was done");
  World& world = with_.loop.world();
  try {
    shards::MapSuccession next = shards::parse_succession(ask.text);
    const bool is_over = next.phase == shards::SuccessionPhase::done && !next.next.find(with_.shard->name);
    succeed(std::move(next));
    // From the next snapshot on, nobody takes what is no longer here for free space.
    if (is_over) world.cover_nothing();
  } catch (const shards::ShardMapError& wrong) {
    throw BadCommand(fmt::format("succession: {}. Nothing was done", wrong.what()));
  }
  keep({KeptKind::succession, "map"}, ask);
  return {{"version", step()}};
}

}  // namespace collided::engine::service
