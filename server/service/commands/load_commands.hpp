#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/service/commands/command_family.hpp"
#include "server/service/commands/scene_loading.hpp"
#include "server/service/commands/upload_receiver.hpp"

namespace collided::engine::service {

/// Loads files: the server's own, and those that clients send.
class LoadCommands : public CommandFamily {
 public:
  /// uploads  folder for files that clients send; empty: uploads are refused
  LoadCommands(CommandContext& context, const std::string& uploads);

  std::vector<BoundCommand> commands() override;
  void stop() override { uploads_.stop(); }
  /// Reads and indexes the file on this thread, then passes the scene to the world's. Throws BadCommand.
  void load_now(CommandAsk ask, const Arguments& arguments) { load_one(parsed(std::move(ask), arguments)); }

 private:
  /// A `load` command, parsed.
  struct Load {
    CommandAsk ask;
    std::string path;
    LoadOptions options;
    std::vector<Aabb> covers;
    bool replace = false;
    bool is_moving = false;                 // its objects take poses
    bool is_durable = false;                // refused if it cannot be stored
    std::optional<std::uint32_t> checksum;  // CRC-32 of the file; nothing: any content is accepted
  };

  Load parsed(CommandAsk ask, const Arguments& arguments) const;
  void load_later(CommandAsk ask, const Arguments& arguments);
  void load_upload(CommandAsk ask, const std::string& path, std::uint32_t checksum);
  void load_one(Load load);
  void refuse_load(const Load& load, const std::string& why, const std::string& hint = {});
  void drop_file_of(const Load& load);
  // On the world's thread.
  nlohmann::json add_scene(const Load& load, LoadedScene& loaded);
  void refuse_foreign_load(const Load& load, const Scene& scene, bool replaces) const;
  void keep_upload(const std::string& scene, const std::string& path);
  void drop_uploads();
  void forget_upload(const std::string& path);

  UploadReceiver uploads_;
  std::map<std::string, std::string> upload_of_scene_;  // path by scene; used by the world's thread alone
};

}  // namespace collided::engine::service
