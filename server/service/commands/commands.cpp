#include "server/service/commands/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cassert>
#include <iterator>
#include <string>
#include <vector>

#include "idl/command_table.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;
namespace names = wire_contract::command;

Commands::Commands(const Collaborators& with, const std::string& uploads)
    : with_(with),
      slow_jobs_(kMostSlowJobs),
      pair_jobs_(kMostPairJobs),
      costly_jobs_(kMostPairJobs),
      geometry_(with.loop.world(), [this](const CommandAsk& ask, ReplyStatus status,
                                          std::string text) { send(ask, status, std::move(text)); }),
      uploads_(
          uploads, with.durable != nullptr ? with.durable->commands_left() : std::vector<CommandAsk>(),
          [this](const CommandAsk& ask, ReplyStatus status, std::string text) { send(ask, status, std::move(text)); },
          [this](CommandAsk ask, const std::string& path, std::uint32_t checksum) {
            load_upload(std::move(ask), path, checksum);
          }) {
  for (const auto& family : {object_commands(), scene_commands(), rule_commands(), probe_commands(), fence_commands(),
                             measuring_commands(), shard_commands(), server_commands(), geometry_.commands()}) {
    for (const BoundCommand& handler : family) handlers_.emplace(handler.name, handler);
  }
  assert(handlers_.size() == std::size(names::kCommands) && "a command of the table has no handler");
  const auto work = [](const char* name, auto& jobs) {
    return named_thread(name, [&jobs] {
      while (std::optional<SlowJob> job = jobs.pop()) (*job)();
    });
  };
  slow_thread_ = work("loads", slow_jobs_);
  pair_thread_ = work("pairs", pair_jobs_);
  costly_thread_ = work("costly pairs", costly_jobs_);
}

Commands::~Commands() { stop(); }

void Commands::stop() {
  stopping_.store(true);
  // Waits for the calls of run() that passed the check before; later ones see stopping_ and refuse.
  { const std::unique_lock alone(gate_); }
  geometry_.stop();
  uploads_.stop();
  end_awaited();
  slow_jobs_.close();
  if (slow_thread_.joinable()) slow_thread_.join();
  pair_jobs_.close();
  if (pair_thread_.joinable()) pair_thread_.join();
  // Closed only now: the thread for pairs may have passed one on until it ended.
  costly_jobs_.close();
  if (costly_thread_.joinable()) costly_thread_.join();
  forget_recordings();
}

/// Sends the result of the work, or the refusal that it threw.
void Commands::answer(const CommandAsk& ask, const std::function<json()>& work) {
  const auto refuse = [&](const std::string& error, const std::string& hint) {
    send(ask, ReplyStatus::refused, refusal_text(error, hint));
  };
  try {
    send(ask, ReplyStatus::ok, work().dump(-1, ' ', false, json::error_handler_t::replace));
  } catch (const BadCommand& bad) { refuse(bad.what(), bad.hint); } catch (const std::bad_alloc&) {
    // On the world's thread half of a change may be in the world by now: the caller ends the process.
    if (with_.loop.runs_here()) throw;
    refuse("not enough memory", "");
  } catch (const std::exception& failed) { refuse(failed.what(), ""); }
}

/// Sends an answer to the client. A command that is carried out again has none: its refusal is a loss, and reported in
/// the log.
void Commands::send(const CommandAsk& ask, ReplyStatus status, std::string text) {
  if (ask.client != 0) return answering_->send_text(ask.client, ask.request, status, std::move(text));
  if (ask.request == 0) return answer_followed(status, text);
  if (status != ReplyStatus::refused) return;
  const json refusal = json::parse(text, nullptr, false);
  if (with_.durable != nullptr && refusal.is_object())
    with_.durable->not_restored(ask.request, refusal.value("error", text));
  with_.loop.say("what was added before the crash cannot be added again: " + text);
}

/// What the keys of whoever sent the command do not allow, or no replica does; empty where it is allowed.
std::string Commands::why_not_allowed(const CommandAsk& ask, const Arguments& arguments) const {
  using wire_contract::QueryRight;
  constexpr std::array kWhat{"greet", "ask", "change the world", "send files"};
  const QueryRight right = names::right_for(arguments.command(), arguments.has("upload"));
  if (!ask.from.has(right))
    return fmt::format("the keys give no right to {}. Nothing was done", kWhat[static_cast<std::size_t>(right)]);
  if (with_.is_replica && ask.client != 0 && right != QueryRight::ask)
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
    std::vector<std::string> known;
    for (const names::CommandSpec& spec : names::kCommands) known.emplace_back(spec.name);
    throw BadCommand(
        fmt::format("unknown command {}{}", printable(arguments.command()), did_you_mean(arguments.command(), known)));
  }
  arguments.refuse_unknown();
  return found->second;
}

void Commands::run(CommandAsk ask) {
  // Held until the command is handed on, so that stop() does not end a thread under it.
  const std::shared_lock on_its_way(gate_);
  if (stopping_.load())
    return send(ask, ReplyStatus::refused, refusal_text("the server is stopping. Nothing was done"));
  const CommandAsk whose{ask.client, ask.request, {}, {}};  // the command itself is handed on
  try {
    const Arguments arguments(ask.text);
    if (const std::string reason = why_not_allowed(ask, arguments); !reason.empty())
      return send(ask, ReplyStatus::refused, refusal_text(reason));
    const BoundCommand& handler = handler_of(arguments);
    if (handler.hand_on) return handler.hand_on(std::move(ask), arguments);
    if (handler.is_on_world_thread) return queue_for_world(std::move(ask), handler, arguments);
    answer(ask, [&] { return handler.work(ask, arguments); });
  } catch (const BadCommand& bad) { send(whose, ReplyStatus::refused, refusal_text(bad.what(), bad.hint)); }
}

/// Has the world's thread carry out a command. A change is answered once it is on the disk; one that looks is answered
/// at once.
void Commands::queue_for_world(CommandAsk ask, const BoundCommand& handler, const Arguments& arguments) {
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  const bool is_change = arguments.spec()->changes_world();
  const bool is_durable = arguments.is_durable();
  once_there_is_room(*shared, is_durable && is_change, [this, shared, &handler, is_change, is_durable] {
    const bool taken = with_.inbox.push_job([this, shared, &handler, is_change, is_durable] {
      const auto work = [&] { return handler.work(*shared, Arguments(shared->text)); };
      is_change ? answer_once_kept(*shared, work, is_durable) : answer(*shared, work);
    });
    if (!taken) { send(*shared, ReplyStatus::refused, refusal_text("too many commands wait already", "ask again")); }
  });
}

}  // namespace collided::engine::service
