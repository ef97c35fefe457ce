#pragma once

#include <string>
#include <vector>

#include "server/service/commands/command_family.hpp"

namespace collided::engine::service {

/// Lists, adds, moves, attaches and removes objects.
class ObjectCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;

  std::vector<BoundCommand> commands() override;
  void look_for_gone() override;
  /// Whether the command removes or moves an object that does not exist. On the world's thread, as all below.
  bool is_moot(const Arguments& arguments) const;
  /// Defers an attachment from before the start if its parent may still come back with its publisher; else false.
  bool put_off(const CommandAsk& ask, const Arguments& arguments);

 private:
  struct Parted {
    CommandAsk ask;
    std::string child;
    std::string parent;
  };

  nlohmann::json list(const Arguments& arguments) const;  // on the thread that asks
  nlohmann::json get(const Arguments& arguments);
  nlohmann::json left_out(const Arguments& arguments);
  nlohmann::json add(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json move(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json remove(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json clear(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json attach(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json detach(const CommandAsk& ask, const Arguments& arguments);

  ObjectId find_object(const std::string& name) const;
  void refuse_if_live(const ObjectInfo& info) const;
  void note_removed(const CommandAsk& ask, const ObjectInfo& info);
  void keep_moved(const ObjectInfo& info, const CommandAsk& ask);
  void keep_detached(const std::string& child);
  nlohmann::json note_ended_attachments();
  nlohmann::json forget_parted(const std::string& child);
  bool are_there(const Parted& parted) const;
  void attach_again();

  std::vector<Parted> parted_;  // by a stop or a crash: attachments whose parents may still come back
};

}  // namespace collided::engine::service
