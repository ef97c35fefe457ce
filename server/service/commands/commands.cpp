#include "server/service/commands/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <future>
#include <iterator>
#include <string>
#include <vector>

#include "idl/command_table.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

Commands::Commands(const Collaborators& with, const std::string& uploads)
    : context_(with), loads_(context_, uploads), geometry_(with.loop.world(), context_.answers) {
  for (const auto& family : {standing_commands, measuring_commands, probe_commands, recording_commands, rule_commands,
                             sampled_commands, server_commands})
    others_.push_back(family(context_));
  with_.place.add_commands(context_, others_);
  const auto bind = [this](std::vector<BoundCommand> commands) {
    for (BoundCommand& command : commands) handlers_.emplace(command.name, std::move(command));
  };
  bind(objects_.commands());
  bind(loads_.commands());
  bind(geometry_.commands());
  for (const auto& family : others_) bind(family->commands());
  assert(std::ranges::all_of(
             names::kCommands,
             [&](const names::CommandSpec& spec) { return spec.is_of_fleet || handlers_.contains(spec.name); }) &&
         "a command of the table has no handler");
}

Commands::~Commands() { stop(); }

void Commands::stop() {
  context_.threads.begin_stop();
  // Waits for the calls of run() that passed the check before; later ones see the stop and refuse.
  { const std::unique_lock alone(gate_); }
  geometry_.stop();
  loads_.stop();
  for (const auto& family : others_) family->stop();
  context_.threads.stop();
  for (const auto& family : others_) family->forget();
}

void Commands::look_for_gone() {
  objects_.look_for_gone();
  for (const auto& family : others_) family->look_for_gone();
  with_.inventory.flush();
}

/// Why the sender's keys, or a replica, do not allow the command; empty: it is allowed.
std::string Commands::why_not_allowed(const CommandAsk& ask, const Arguments& arguments) const {
  using wire_contract::QueryRight;
  constexpr std::array kWhat{"greet", "ask", "change the world", "send files"};
  const QueryRight right = names::right_for(arguments.command(), arguments.has("upload"));
  if (!ask.from.has(right))
    return fmt::format("the keys give no right to {}. Nothing was done", kWhat[static_cast<std::size_t>(right)]);
  if (with_.place.is_replica() && ask.client != 0 && right != QueryRight::ask)
    return "this is a replica: what changes the world goes to its primary. Nothing was done";
  const bool only_looks = right == QueryRight::ask || right == QueryRight::greet;
  if (!ask.from.peer || ask.from.peer->objects.empty() || only_looks) return {};
  const names::KeyedObjects objects = arguments.spec()->objects;
  if (objects == names::KeyedObjects::each) return {};
  if (objects == names::KeyedObjects::named && ask.from.peer->may_name(arguments.text("name"))) return {};
  return fmt::format("the keys of '{}' are for {}. Nothing was done", ask.from.peer->name,
                     fmt::join(ask.from.peer->objects, ", "));
}

/// The handler of a command that takes these arguments; throws BadCommand.
const BoundCommand& Commands::handler_of(const Arguments& arguments) const {
  const auto found = handlers_.find(arguments.command());
  if (found == handlers_.end()) {
    if (arguments.spec() != nullptr)
      throw BadCommand(fmt::format("this server is built without the fleet, and has no command {}. Nothing was done",
                                   arguments.command()));
    std::vector<std::string> known;
    for (const names::CommandSpec& spec : names::kCommands) known.emplace_back(spec.name);
    throw BadCommand(
        fmt::format("unknown command {}{}", printable(arguments.command()), did_you_mean(arguments.command(), known)));
  }
  arguments.refuse_unknown();
  return found->second;
}

void Commands::run(CommandAsk ask) {
  // Held until the command is passed on, so that stop() does not end a thread under it.
  const std::shared_lock on_its_way(gate_);
  if (context_.threads.are_stopping()) return answers_.refuse(ask, "the server is stopping. Nothing was done");
  const CommandAsk whose{ask.client, ask.request, {}, {}};  // the command itself is moved on
  try {
    const Arguments arguments(ask.text);
    if (const std::string reason = why_not_allowed(ask, arguments); !reason.empty())
      return answers_.refuse(ask, reason);
    const BoundCommand& handler = handler_of(arguments);
    if (handler.hand_on) return handler.hand_on(std::move(ask), arguments);
    if (handler.is_on_world_thread) return queue_for_world(std::move(ask), handler, arguments);
    answers_.answer(ask, [&] { return handler.work(ask, arguments); });
  } catch (const BadCommand& bad) { answers_.refuse(whose, bad); }
}

/// Queues a command for the world's thread. A change is answered once it is on disk, a command that only reads at once.
void Commands::queue_for_world(CommandAsk ask, const BoundCommand& handler, const Arguments& arguments) {
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  const bool is_change = arguments.spec()->changes_world();
  const bool is_durable = arguments.is_durable();
  answers_.once_there_is_room(*shared, is_durable && is_change, [this, shared, &handler, is_change, is_durable] {
    const bool taken = with_.inbox.push_job([this, shared, &handler, is_change, is_durable] {
      const auto work = [&] { return handler.work(*shared, Arguments(shared->text)); };
      is_change ? answers_.answer_once_kept(*shared, work, is_durable) : answers_.answer(*shared, work);
    });
    if (!taken) answers_.refuse(*shared, "too many commands wait already", "ask again");
  });
}

std::string Commands::follow(CommandAsk ask) {
  std::future<std::string> refusal = answers_.followed();
  try {
    const Arguments arguments(ask.text);
    const BoundCommand& handler = handler_of(arguments);
    if (arguments.command() == names::kLoad) {
      loads_.load_now(std::move(ask), arguments);
    } else {
      if (!handler.is_on_world_thread) return "the command changes nothing";
      const bool taken = with_.inbox.push_job([this, &handler, ask = std::move(ask)] {
        answers_.answer_once_kept(ask, [&] { return handler.work(ask, Arguments(ask.text)); });
      });
      if (!taken) return "too many commands wait already";
    }
  } catch (const BadCommand& bad) { return bad.what(); }
  constexpr std::chrono::milliseconds kLook{50};
  while (!context_.threads.are_stopping()) {
    if (refusal.wait_for(kLook) != std::future_status::ready) continue;
    return refusal.get();
  }
  return "the server is stopping";
}

/// Loads the scenes on the thread for slow work, then repeats additions, moves and probes on the world's, as some need
/// those scenes.
void Commands::replay(const std::vector<KeptCommand>& left) {
  if (left.empty()) return;
  std::vector<CommandAsk> asks;
  for (const KeptCommand& command : left) asks.push_back({0, asks.size() + 1, command.text, command.blob});
  replaying_.store(true);
  const bool is_taken = context_.threads.push_slow([this, asks] {
    std::vector<CommandAsk> others;
    for (const CommandAsk& ask : asks) {
      if (!with_.durable->is_due(ask.request)) continue;
      try {
        const Arguments arguments(ask.text);
        if (arguments.command() == names::kLoad) {
          static_cast<void>(handler_of(arguments));
          loads_.load_now(ask, arguments);
        } else if (arguments.command() == names::kClear) {
          with_.inbox.push_own_job([this, ask] { replay_on_world_thread({ask}); });
        } else {
          others.push_back(ask);
        }
      } catch (const BadCommand& bad) { answers_.refuse(ask, bad); }
    }
    with_.inbox.push_own_job([this, others] {
      replay_on_world_thread(others);
      replaying_.store(false);
    });
  });
  if (!is_taken) throw std::runtime_error(CommandThreads::kNoThread);
}

void Commands::replay_on_world_thread(const std::vector<CommandAsk>& asks) {
  for (const CommandAsk& ask : asks) {
    if (!with_.durable->is_due(ask.request)) continue;
    const Arguments arguments(ask.text);
    if (objects_.put_off(ask, arguments)) continue;
    if (objects_.is_moot(arguments)) {
      drop_if_moot_for_good(ask);
      continue;
    }
    answers_.answer_once_kept(ask, [&] { return handler_of(arguments).work(ask, arguments); });
  }
}

/// Drops a stored command about a part that its scene no longer has. If the scene itself is missing, it may come back.
void Commands::drop_if_moot_for_good(const CommandAsk& ask) {
  const KeptKey& key = with_.durable->commands_left().at(ask.request - 1).key;
  const std::string scene = key.scene();
  const SnapshotRing::Lease state = with_.loop.world().newest();
  const bool is_there = std::ranges::any_of(state->scenes, [&](const auto& loaded) { return loaded->name == scene; });
  if (!is_there) return;
  with_.loop.say(fmt::format("scene {} has other parts than before. Dropped: {}", printable(scene), ask.text));
  with_.inventory.erase(key);
  with_.inventory.flush();
}

}  // namespace collided::engine::service
