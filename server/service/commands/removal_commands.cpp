#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <vector>

#include "idl/answers/commands.hpp"
#include "idl/described_json.hpp"
#include "server/service/commands/object_commands.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

bool is_glob(const std::string& name) { return name.find_first_of("*?[") != std::string::npos; }

}  // namespace

/// The start options or a scene's file may have changed since the last start, and an object that a command had added
/// may be lost.
bool ObjectCommands::is_moot(const Arguments& arguments) const {
  const World& world = with_.loop.world();
  if (arguments.command() == names::kRemove || arguments.command() == names::kMove)
    return !world.find(arguments.text("name"));
  if (arguments.command() != names::kClear) return false;
  const std::string scene = arguments.text("scene");
  return std::ranges::none_of(world.newest()->scenes, [&](const auto& loaded) { return loaded->name == scene; });
}

json ObjectCommands::remove(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const std::string name = arguments.text("name");
  std::vector<ObjectId> chosen;
  if (is_glob(name) && !world.find(name)) {
    for (const auto& info : world.objects()) {
      if (info && glob_matches(name, info->name)) chosen.push_back(info->id);
    }
  } else {
    chosen.push_back(find_object(name));
  }
  // All or nothing: every chosen object is checked before the first one is removed.
  for (const ObjectId id : chosen) {
    const ObjectInfo& info = *world.info(id);
    refuse_if_live(info);
    refuse_if_foreign(ask, info.name, "removed");
  }
  if (std::any_of(chosen.begin(), chosen.end(), [&](ObjectId id) { return world.has_moved(id); }))
    with_.loop.step_now();
  std::vector<std::string> removed;
  for (const ObjectId id : chosen) {
    const ObjectInfo& info = *world.info(id);
    removed.push_back(info.name);
    note_removed(ask, info);
    world.remove(id, EndReason::removed);
  }
  if (chosen.empty()) return json_of(Removed{.names = {}, .version = world.newest()->version});
  const std::uint64_t version = step();
  json answer = json_of(Removed{.names = removed, .contacts_ended = ended_count(), .version = version});
  if (json detached = note_ended_attachments(); !detached.empty()) answer["detached"] = std::move(detached);
  return answer;
}

/// The file of a scene still contains the removed part, so its removal is stored.
void ObjectCommands::note_removed(const CommandAsk& ask, const ObjectInfo& info) {
  const std::string& scene = info.rare->scene;
  if (info.publisher != 0) return with_.inventory.erase({KeptKind::published, info.name});
  if (scene.empty()) return with_.inventory.erase({KeptKind::object, info.name});
  const json again{{"command", names::kRemove}, {"name", info.name}};
  keep(KeptKey::of_member(KeptKind::gone, scene, info.name), {ask.client, ask.request, again.dump(), {}});
}

/// Removes scenes and objects. Objects of live publishers stay and are counted as kept; so do objects that the sender's
/// keys do not cover, and scenes with such an object. One scene by its name is refused instead.
json ObjectCommands::clear(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const std::string scene = arguments.text("scene");
  const bool moving = arguments.truth("moving");
  std::vector<std::string> scenes;
  for (const auto& loaded : world.newest()->scenes) scenes.push_back(loaded->name);
  if (!scene.empty() && std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) {
    throw BadCommand(fmt::format("scene {} is not loaded; loaded: {}", printable(scene),
                                 scenes.empty() ? "none" : fmt::format("{}", fmt::join(scenes, ", "))));
  }
  if (const ObjectInfo* foreign = scene.empty() ? nullptr : foreign_in_scene(ask, scene))
    refuse_if_foreign(ask, foreign->name, "removed");
  with_.loop.step_now();  // poses that have changed are examined before their objects go
  std::uint32_t removed = 0;
  std::uint32_t kept = 0;
  std::set<std::string_view> kept_scenes;
  for (const std::string& name : scenes) {
    if (name != scene && !(scene.empty() && !moving)) continue;
    if (foreign_in_scene(ask, name) != nullptr) {
      kept_scenes.insert(name);
      continue;
    }
    removed += world.remove_scene(name);
    with_.inventory.erase({KeptKind::scene, name});
  }
  const bool others = scene.empty() || moving;
  const ObjectTable objects = world.objects();  // a copy: removing changes the world's
  for (const auto& info : objects) {
    if (!others || !info || !world.info(info->id) || (moving && !info->moving)) continue;
    const bool is_live = info->publisher != 0 && with_.loop.publishers().is_live(info->publisher);
    if (is_live || kept_scenes.contains(info->rare->scene) || (ask.from.peer && !ask.from.peer->may_name(info->name))) {
      ++kept;
    } else if (world.remove(info->id, EndReason::removed)) {
      ++removed;
      note_removed(ask, *info);
    }
  }
  const std::uint64_t version = step();
  json answer = json_of(Cleared{.removed = removed, .kept = kept, .contacts_ended = ended_count(), .version = version});
  if (json detached = note_ended_attachments(); !detached.empty()) answer["detached"] = std::move(detached);
  return answer;
}

}  // namespace collided::engine::service
