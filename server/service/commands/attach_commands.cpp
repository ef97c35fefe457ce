#include <fmt/format.h>

#include <algorithm>

#include "idl/described_json.hpp"
#include "server/service/commands/object_commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"

// Objects that move along with others.
namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

json ObjectCommands::attach(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const ObjectId child = find_object(arguments.text("child"));
  const ObjectId parent = find_object(arguments.text("parent"));
  const ObjectInfo& info = *world.info(child);
  refuse_if_foreign(ask, info.name, "attached");
  if (info.publisher != 0)
    throw BadCommand(fmt::format("object {} cannot be attached: publisher {} moves it{}", printable(info.name),
                                 printable(with_.loop.publisher_name(info.publisher)),
                                 with_.loop.publishers().is_live(info.publisher) ? "" : ", and may come back"),
                     "what no publisher has can be attached, such as what add puts there");
  // The parent leaves this shard, and the child would stay behind: no other shard knows of it.
  const ObjectInfo& carrier = *world.info(parent);
  if (with_.loop.publishers().is_in_several_shards(carrier.publisher))
    throw BadCommand(
        fmt::format("object {} cannot be attached to {}: publisher {} moves that from shard to shard, and {} "
                    "would stay in this one. It is not attached",
                    printable(info.name), printable(carrier.name),
                    printable(with_.loop.publisher_name(carrier.publisher)), printable(info.name)),
        "have that publisher move both");
  // Where the two are to each other is taken from poses that a step has examined.
  if (world.has_moved(child) || world.has_moved(parent)) with_.loop.step_now();
  if (const std::optional<Refusal> refusal = world.attach(child, parent, arguments.pose("pose")))
    throw BadCommand(refusal->reason);
  const AttachedObject& attached = *world.attachments().find(child);
  if (with_.durable != nullptr) {
    const json again{{"command", names::kAttach},
                     {"child", attached.child_name},
                     {"parent", attached.parent_name},
                     {"pose", json_of(attached.in_parent)}};
    with_.durable->attached(attached.child_name, again.dump());
  }
  json answer{{"child", attached.child_name}, {"parent", attached.parent_name}, {"pose", json_of(attached.in_parent)}};
  answer["version"] = step();
  return answer;
}

/// Keeps that a child is free, and where it is.
void ObjectCommands::keep_detached(const std::string& child) {
  const World& world = with_.loop.world();
  const std::optional<ObjectId> id = world.find(child);
  if (with_.durable != nullptr) with_.durable->detached(child);
  if (!id) return;
  const SnapshotRing::Lease state = world.newest();
  const json again{
      {"command", names::kMove}, {"name", child}, {"pose", json_of(state->poses[slot_of(*id)])}, {"teleport", true}};
  const CommandAsk ask{0, 0, again.dump(), {}};
  answers_.tell_flight_recorder(ask);
  if (with_.durable != nullptr) with_.durable->object_moved(world.info(*id)->rare->scene, child, ask);
}

json ObjectCommands::detach(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const ObjectId child = find_object(arguments.text("child"));
  const AttachedObject* attached = world.attachments().find(child);
  const std::string name = world.info(child)->name;
  refuse_if_foreign(ask, name, "detached");
  if (attached == nullptr) throw BadCommand(fmt::format("object {} is not attached to anything", printable(name)));
  const std::string parent = attached->parent_name;
  if (world.has_moved(child)) with_.loop.step_now();
  world.detach(child);
  const std::uint64_t version = step();
  keep_detached(name);
  return {{"child", name}, {"parent", parent}, {"version", version}};
}

/// Says of attachments that they ended, and keeps that. Returns the names of what was attached and is still there.
json ObjectCommands::note_ended_attachments() {
  json detached = json::array();
  for (const EndedAttachment& ended : with_.loop.world().take_ended_attachments()) {
    with_.loop.say(fmt::format("object {} is no longer attached to {}: {} was removed", printable(ended.child),
                               printable(ended.parent), printable(ended.is_child_there ? ended.parent : ended.child)));
    if (ended.is_child_there) {
      keep_detached(ended.child);
      detached.push_back(ended.child);
    } else if (with_.durable != nullptr) {
      with_.durable->detached(ended.child);
    }
  }
  return detached;
}

bool ObjectCommands::put_off(const CommandAsk& ask, const Arguments& arguments) {
  if (arguments.command() != names::kAttach || with_.loop.world().find(arguments.text("parent"))) return false;
  parted_.push_back(ask);
  return true;
}

void ObjectCommands::look_for_gone() {
  static_cast<void>(note_ended_attachments());
  attach_again();
}

/// Attaches again what a crash has parted, where the parent may still have to come back with its publisher.
void ObjectCommands::attach_again() {
  const bool is_last_try = !with_.loop.recovering();
  std::erase_if(parted_, [&](const CommandAsk& ask) {
    if (!with_.durable->is_due(ask.request)) return true;
    const Arguments arguments(ask.text);
    const World& world = with_.loop.world();
    const bool are_there = world.find(arguments.text("child")) && world.find(arguments.text("parent"));
    if (!are_there && !is_last_try) return false;
    answers_.answer_once_kept(ask, [&] { return attach(ask, arguments); });
    return true;
  });
}

}  // namespace collided::engine::service
