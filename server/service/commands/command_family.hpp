#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "server/service/commands/bound_command.hpp"
#include "server/service/commands/command_answers.hpp"
#include "server/service/commands/command_threads.hpp"

namespace collided::engine::service {

/// What all families of commands share. It must outlive them.
struct CommandContext {
  explicit CommandContext(const CommandCollaborators& given) : with(given) {}

  const CommandCollaborators with;
  CommandAnswers answers{with};
  CommandThreads threads;
};

/// Commands about one subject, with their handlers.
class CommandFamily {
 public:
  explicit CommandFamily(CommandContext& context)
      : with_(context.with), answers_(context.answers), threads_(context.threads) {}
  virtual ~CommandFamily() = default;
  CommandFamily(const CommandFamily&) = delete;
  CommandFamily& operator=(const CommandFamily&) = delete;

  /// Its commands with their handlers, which must not outlive it.
  virtual std::vector<BoundCommand> commands() = 0;
  /// Called regularly on the world's thread: gives up what belongs to clients that have gone.
  virtual void look_for_gone() {}
  /// Called when no more commands come; jobs may still be under way.
  virtual void stop() {}
  /// Called after stop(), when all jobs are done.
  virtual void forget() {}

 protected:
  // On the world's thread.
  /// Throws BadCommand if the keys of the command's sender do not cover objects of this name.
  static void refuse_if_foreign(const CommandAsk& ask, std::string_view object, const char* not_done);
  /// The first object of a scene that the keys of the command's sender do not cover; null if there is none.
  const ObjectInfo* foreign_in_scene(const CommandAsk& ask, std::string_view scene) const;
  /// Puts a command into the inventory. owner: as in KeptCommand.
  void keep(KeptKey key, const CommandAsk& ask, std::uint64_t owner = 0);
  /// Makes a change visible by a step; returns the new version.
  std::uint64_t step();
  std::uint32_t ended_count() const;

  const CommandCollaborators& with_;
  CommandAnswers& answers_;
  CommandThreads& threads_;
};

// The families of which other files use only the commands.
std::unique_ptr<CommandFamily> standing_commands(CommandContext& context);
std::unique_ptr<CommandFamily> measuring_commands(CommandContext& context);
std::unique_ptr<CommandFamily> probe_commands(CommandContext& context);
std::unique_ptr<CommandFamily> recording_commands(CommandContext& context);
std::unique_ptr<CommandFamily> rule_commands(CommandContext& context);
std::unique_ptr<CommandFamily> sampled_commands(CommandContext& context);
std::unique_ptr<CommandFamily> server_commands(CommandContext& context);

}  // namespace collided::engine::service
