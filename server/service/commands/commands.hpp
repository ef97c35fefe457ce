#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/service/commands/command_family.hpp"
#include "server/service/commands/geometry_service.hpp"
#include "server/service/commands/load_commands.hpp"
#include "server/service/commands/object_commands.hpp"

namespace collided::engine::service {

/// Carries out the commands of idl/command_table.hpp, whose handlers are in the families. Most that only read are
/// answered on the thread that asks, on a snapshot; one that changes the world becomes a job of the world's thread;
/// files, pairs of objects and shapes have threads of their own.
class Commands {
 public:
  using Collaborators = CommandCollaborators;

  /// uploads  folder for files that clients send; empty: uploads are refused
  Commands(const Collaborators& with, const std::string& uploads);
  ~Commands();

  /// Sets where the answers go. Call this before the first run().
  void connect(Answering& answering) { context_.answers.connect(answering); }
  /// Repeats the commands of an earlier process: scenes on a thread of their own, the rest on the world's. Call this
  /// after connect(); returns at once.
  void replay(const std::vector<KeptCommand>& left);
  /// Carries out a command that has changed another server's world, and waits for it. Returns why it was refused;
  /// empty: it was not. One thread, not the world's.
  std::string follow(CommandAsk ask);
  /// Whether replay() is complete. Any thread.
  bool replayed() const { return !replaying_.load(); }
  /// Carries out a command. Any thread; returns at once, or after reading. The answer comes through
  /// Answering::send_text().
  void run(CommandAsk ask);
  /// Call this regularly, on the world's thread: calls off pairs, clearances and menus whose clients have gone, and
  /// removes their fences.
  void look_for_gone();
  /// Calls off the load under way and ends the threads; commands that come later are refused.
  void stop();

 private:
  std::string why_not_allowed(const CommandAsk& ask, const Arguments& arguments) const;
  const BoundCommand& handler_of(const Arguments& arguments) const;
  void queue_for_world(CommandAsk ask, const BoundCommand& handler, const Arguments& arguments);
  void replay_on_world_thread(const std::vector<CommandAsk>& asks);
  void drop_if_moot_for_good(const CommandAsk& ask);

  CommandContext context_;
  const Collaborators& with_ = context_.with;
  CommandAnswers& answers_ = context_.answers;
  ObjectCommands objects_{context_};
  LoadCommands loads_;
  GeometryService geometry_;
  std::vector<std::unique_ptr<CommandFamily>> others_;
  std::map<std::string_view, BoundCommand> handlers_;
  std::atomic<bool> replaying_{false};
  std::shared_mutex gate_;  // held shared while run() passes a command on; stop() takes it alone once
};

}  // namespace collided::engine::service
