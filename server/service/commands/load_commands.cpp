#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <zlib.h>

#include "idl/described_json.hpp"
#include "server/service/commands/load_commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/query/plan.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;
namespace names = wire_contract::command;

namespace {

constexpr std::int64_t kProgressPeriodNs = 100'000'000;

/// CRC-32 of a file; nothing if it cannot be read.
std::optional<std::uint32_t> checksum_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> bytes(std::size_t{1} << 20);
  uLong sum = crc32_z(0, nullptr, 0);
  while (file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())) || file.gcount() > 0)
    sum = crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<std::size_t>(file.gcount()));
  if (!file.eof()) return std::nullopt;
  return static_cast<std::uint32_t>(sum);
}

/// Whether the command or the file says where geometry is complete.
bool states_covers(const std::vector<Aabb>& by_command, const Scene& scene) {
  return !by_command.empty() || (scene.frozen && scene.frozen->covers);
}

}  // namespace

LoadCommands::LoadCommands(CommandContext& context, const std::string& uploads)
    : CommandFamily(context),
      uploads_(uploads, with_.durable != nullptr ? with_.durable->commands_left() : std::vector<KeptCommand>(),
               context.answers, [this](CommandAsk ask, const std::string& path, std::uint32_t checksum) {
                 load_upload(std::move(ask), path, checksum);
               }) {
  answers_.after_change([this] { drop_uploads(); });
}

std::vector<BoundCommand> LoadCommands::commands() {
  std::vector<BoundCommand> commands = uploads_.commands();
  commands.push_back(handed_on(names::kLoad, this, &LoadCommands::load_later));
  return commands;
}

/// The command with its arguments checked. Throws BadCommand.
LoadCommands::Load LoadCommands::parsed(CommandAsk ask, const Arguments& arguments) const {
  Load load;
  load.path = arguments.text("path");
  load.options.name = arguments.text("name");
  load.options.unit_m = arguments.number("unit_m");
  load.options.radius_m = arguments.number("radius_m");
  const std::string up = arguments.text("up");
  load.options.strict = arguments.truth("strict");
  load.replace = arguments.truth("replace");
  load.is_moving = arguments.truth("moving");
  if (load.path.empty()) throw BadCommand("load: without a path");
  if (!load.options.name.empty() && !is_good_name(load.options.name))
    throw BadCommand("load: the name is too long or not text");
  if (!up.empty() && up != "y" && up != "z") {
    throw BadCommand(fmt::format("load: up is {}; allowed: 'y' or 'z', or nothing: as the format says", printable(up)));
  }
  const double crack_m = arguments.number("crack_m");
  if (!(crack_m >= 0)) throw BadCommand(fmt::format("load: crack_m is {}; allowed: 0 and more", crack_m));
  if (arguments.truth("mend")) load.options.mend_m = crack_m;
  load.options.srdf = arguments.text("srdf");
  load.options.packages = arguments.texts("packages");
  load.options.solid = arguments.text("solid");
  load.options.solid_by_winding = arguments.is_solid_by_winding();
  load.options.is_foreign = arguments.truth("foreign");
  load.covers = arguments.boxes("covers");
  if (with_.shard != nullptr && !load.covers.empty())
    throw BadCommand("load: this server is a shard, and covers what it holds. Nothing was loaded");
  load.is_durable = arguments.is_durable();
  if (arguments.has("crc32")) load.checksum = arguments.whole_32("crc32");
  if (!(load.options.unit_m > 0))
    throw BadCommand(fmt::format("load: unit_m is {}; allowed: greater than 0", load.options.unit_m));
  load.options.up = up.empty() ? '\0' : up[0];
  load.ask = std::move(ask);
  return load;
}

void LoadCommands::load_later(CommandAsk ask, const Arguments& arguments) {
  if (arguments.has("upload")) return uploads_.take_load(std::move(ask));
  threads_.require_room("load");
  const auto shared = std::make_shared<Load>(parsed(std::move(ask), arguments));
  answers_.once_there_is_room(shared->ask, shared->is_durable, [this, shared] {
    if (!threads_.push_slow([this, shared] { load_one(std::move(*shared)); }))
      answers_.refuse(shared->ask, CommandThreads::kNoThread);
  });
}

/// Loads an uploaded file as if the command had named its path. The text gets the path too, since the next process
/// repeats it.
void LoadCommands::load_upload(CommandAsk ask, const std::string& path, std::uint32_t checksum) {
  json words = json::parse(ask.text);
  words.erase("upload");
  words["path"] = path;
  words["foreign"] = true;
  words["crc32"] = checksum;
  ask.text = words.dump();
  const Arguments arguments(ask.text);
  load_later(std::move(ask), arguments);
}

/// Reads and indexes the file on the thread for slow work, then passes the scene to the world's thread.
void LoadCommands::load_one(Load load) {
  const CommandAsk& ask = load.ask;
  std::atomic<std::int64_t> reported_ns{steady_ns()};
  load.options.cancelled = [this] { return threads_.are_stopping(); };
  load.options.progress = [&](double fraction) {
    std::int64_t last_ns = reported_ns.load();
    const std::int64_t now_ns = steady_ns();
    // Any of the threads that build may call this; one of them sends.
    if (now_ns - last_ns < kProgressPeriodNs || !reported_ns.compare_exchange_strong(last_ns, now_ns)) return;
    answers_.send(ask, ReplyStatus::progress, fmt::format("{{\"fraction\": {:.4f}}}", fraction));
  };
  const auto loaded = std::make_shared<LoadedScene>();
  try {
    if (load.checksum && checksum_of(load.path) != load.checksum)
      throw LoadError(load.path + ": the file is not what was uploaded. Nothing was loaded.");
    *loaded = load_and_index(load.path, load.options, with_.shard, load.is_moving);
  } catch (const LoadError& failed) { return refuse_load(load, failed.what()); } catch (const std::bad_alloc&) {
    return refuse_load(load, load.path + ": not enough memory. Nothing was loaded.");
  } catch (const std::exception& failed) {
    return refuse_load(load, fmt::format("{}: {}. Nothing was loaded.", load.path, failed.what()));
  }
  load.options = {};  // its functions refer to locals
  const auto shared = std::make_shared<Load>(std::move(load));
  // Loads wait in a queue of their own, so few of these wait at a time; and the work is already done.
  with_.inbox.push_own_job([this, shared, loaded] {
    bool is_added = false;
    answers_.answer_once_kept(
        shared->ask,
        [&] {
          json answer = add_scene(*shared, *loaded);
          is_added = true;
          return answer;
        },
        shared->is_durable);
    is_added ? keep_upload(loaded->indexed.scene.name, shared->path) : drop_file_of(*shared);
  });
}

void LoadCommands::refuse_load(const Load& load, const std::string& why, const std::string& hint) {
  drop_file_of(load);
  answers_.refuse(load.ask, why, hint);
}

/// Removes the uploaded file of a failed load. A repeated load keeps it: the journal still names it, and the next start
/// may have enough memory, or find the name free. The next start removes it once nothing names it.
void LoadCommands::drop_file_of(const Load& load) {
  if (load.ask.client != 0) uploads_.forget(load.path);
}

/// Throws BadCommand if the sender's keys do not cover a name that the scene adds, or that is removed for it. To
/// declare space complete, keys for all names are needed, since that concerns the whole world.
void LoadCommands::refuse_foreign_load(const Load& load, const Scene& scene, bool replaces) const {
  for (const Part& part : scene.parts) refuse_if_foreign(load.ask, part.name, "loaded");
  for (const SceneObject& object : scene.objects) refuse_if_foreign(load.ask, object.name, "loaded");
  const ObjectInfo* const foreign = replaces ? foreign_in_scene(load.ask, scene.name) : nullptr;
  if (foreign != nullptr) refuse_if_foreign(load.ask, foreign->name, "loaded");
  const KeyedPeer* const peer = load.ask.from.peer.get();
  if (states_covers(load.covers, scene) && peer != nullptr && !peer->objects.empty())
    throw BadCommand(fmt::format("the keys of '{}' are for {}; covers are said of the whole world. Nothing was loaded",
                                 peer->name, fmt::join(peer->objects, ", ")));
}

/// Puts a loaded scene into the world, if asked in place of the one of its name. On the world's thread; throws
/// BadCommand, and then nothing was added.
json LoadCommands::add_scene(const Load& load, LoadedScene& loaded) {
  World& world = with_.loop.world();
  const Scene& scene = loaded.indexed.scene;
  const auto& scenes = world.newest()->scenes;
  const bool there =
      std::any_of(scenes.begin(), scenes.end(), [&](const auto& other) { return other->name == scene.name; });
  if (there && !load.replace) {
    throw BadCommand(fmt::format("scene {} is loaded already", printable(scene.name)),
                     "--replace it, or load under another --name");
  }
  refuse_foreign_load(load, scene, there);
  if (there) {
    if (const std::optional<Refusal> refusal = world.refusal_of(scene, true)) throw BadCommand(refusal->reason);
    with_.loop.step_now();
    world.remove_scene(scene.name);
    with_.loop.note_change();
  }
  loaded.indexed.geometry->source = load.ask.text;
  loaded.indexed.scene.is_moving = load.is_moving;
  const std::variant<std::uint32_t, Refusal> added = world.add_scene(loaded.indexed);
  if (const auto* refusal = std::get_if<Refusal>(&added)) throw BadCommand(refusal->reason);
  if (!load.covers.empty()) world.state_covers(scene.name, load.covers);
  keep({KeptKind::scene, scene.name}, load.ask);
  if (with_.durable != nullptr && states_covers(load.covers, scene)) with_.durable->covers_stated();
  Loaded report{.scene = scene.name,
                .triangles = loaded.triangles,
                .parts = scene.parts.size(),
                .objects = scene.objects.size(),
                .seconds = loaded.seconds,
                .placed = loaded.report.placed,
                .notes = loaded.report.notes,
                .mended = loaded.report.mended,
                .refused = loaded.report.refused,
                .warnings = loaded.report.warnings,
                .left_out = {},
                .covers = covered_boxes(load.covers),
                .version = step()};
  for (const PlanRow& row : plan_of(*world.newest(), with_.loop.contacts_wanted())) {
    if (!row.built) report.left_out.push_back(fmt::format("{}: {}", row.structure, row.reason));
  }
  json answer = json_of(report);
  if (scene.tiles) answer["tiles"] = tiles_json(*scene.tiles);
  return answer;
}

/// Keeps the uploaded file of a scene, which the next process needs, and drops that of the replaced scene.
void LoadCommands::keep_upload(const std::string& scene, const std::string& path) {
  if (const auto before = upload_of_scene_.find(scene); before != upload_of_scene_.end()) {
    forget_upload(before->second);
    upload_of_scene_.erase(before);
  }
  if (uploads_.has_taken(path)) upload_of_scene_[scene] = path;
}

/// Removes the uploaded files of scenes that are gone.
void LoadCommands::drop_uploads() {
  const World& world = with_.loop.world();
  const auto has_scene = [&](std::string_view name) {
    const SnapshotRing::Lease state = world.newest();
    return std::any_of(state->scenes.begin(), state->scenes.end(),
                       [&](const auto& scene) { return scene->name == name; });
  };
  for (auto upload = upload_of_scene_.begin(); upload != upload_of_scene_.end();) {
    const auto here = upload++;
    if (has_scene(here->first)) continue;
    forget_upload(here->second);
    upload_of_scene_.erase(here);
  }
}

/// Removes an uploaded file once the journal no longer names it: a process started before that loads it again.
void LoadCommands::forget_upload(const std::string& path) {
  if (with_.durable == nullptr) return uploads_.forget(path);
  with_.durable->then([this, path](const std::string& not_kept) {
    if (not_kept.empty()) uploads_.forget(path);
  });
}

}  // namespace collided::engine::service
