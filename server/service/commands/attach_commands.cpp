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
  // The parent would leave this shard and the child would stay behind, since no other shard knows it.
  const ObjectInfo& carrier = *world.info(parent);
  if (with_.loop.publishers().is_in_several_shards(carrier.publisher))
    throw BadCommand(
        fmt::format("object {} cannot be attached to {}: publisher {} moves that from shard to shard, and {} "
                    "would stay in this one. It is not attached",
                    printable(info.name), printable(carrier.name),
                    printable(with_.loop.publisher_name(carrier.publisher)), printable(info.name)),
        "have that publisher move both");
  // Their relative pose is taken from poses that a step has examined.
  if (world.has_moved(child) || world.has_moved(parent)) with_.loop.step_now();
  if (const std::optional<Refusal> refusal = world.attach(child, parent, arguments.pose("pose")))
    throw BadCommand(refusal->reason);
  const AttachedObject& attached = *world.attachments().find(child);
  const json again{{"command", names::kAttach},
                   {"child", attached.child_name},
                   {"parent", attached.parent_name},
                   {"pose", json_of(attached.in_parent)}};
  keep({KeptKind::attached, attached.child_name}, {0, 0, again.dump(), {}});
  // It was kept, but left out of the state for followers as long as its parent was missing.
  if (ask.is_carried_out_again()) with_.place.changed(ask);
  json answer{{"child", attached.child_name}, {"parent", attached.parent_name}, {"pose", json_of(attached.in_parent)}};
  answer["version"] = step();
  return answer;
}

/// Stores that a child is free, and its pose.
void ObjectCommands::keep_detached(const std::string& child) {
  const World& world = with_.loop.world();
  const std::optional<ObjectId> id = world.find(child);
  with_.inventory.erase({KeptKind::attached, child});
  if (!id) return;
  const SnapshotRing::Lease state = world.newest();
  const json again{
      {"command", names::kMove}, {"name", child}, {"pose", json_of(state->poses[slot_of(*id)])}, {"teleport", true}};
  const CommandAsk ask{0, 0, again.dump(), {}};
  if (with_.flight != nullptr) with_.flight->note_own(ask.text, ask.blob);
  keep_moved(*world.info(*id), ask);
}

json ObjectCommands::detach(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const ObjectId child = find_object(arguments.text("child"));
  const AttachedObject* attached = world.attachments().find(child);
  const std::string name = world.info(child)->name;
  refuse_if_foreign(ask, name, "detached");
  if (attached == nullptr) return forget_parted(name);
  const std::string parent = attached->parent_name;
  if (world.has_moved(child)) with_.loop.step_now();
  world.detach(child);
  const std::uint64_t version = step();
  keep_detached(name);
  return {{"child", name}, {"parent", parent}, {"version", version}};
}

/// Gives up an attachment from before the start whose parent has not come back. Throws BadCommand if there is none.
json ObjectCommands::forget_parted(const std::string& child) {
  const auto parted = std::ranges::find(parted_, child, &Parted::child);
  if (parted == parted_.end() || !with_.durable->is_due(parted->ask.request))
    throw BadCommand(fmt::format("object {} is not attached to anything", printable(child)));
  const std::string parent = parted->parent;
  with_.inventory.erase({KeptKind::attached, child});
  return {{"child", child}, {"parent", parent}, {"version", with_.loop.world().newest()->version}};
}

/// Logs and stores that attachments ended. Returns the names of detached objects that still exist.
json ObjectCommands::note_ended_attachments() {
  json detached = json::array();
  for (const EndedAttachment& ended : with_.loop.world().take_ended_attachments()) {
    with_.loop.say(fmt::format("object {} is no longer attached to {}: {} was removed", printable(ended.child),
                               printable(ended.parent), printable(ended.is_child_there ? ended.parent : ended.child)));
    if (ended.is_child_there) {
      keep_detached(ended.child);
      detached.push_back(ended.child);
    } else {
      with_.inventory.erase({KeptKind::attached, ended.child});
    }
  }
  return detached;
}

bool ObjectCommands::put_off(const CommandAsk& ask, const Arguments& arguments) {
  if (arguments.command() != names::kAttach) return false;
  Parted parted{.ask = ask, .child = arguments.text("child"), .parent = arguments.text("parent")};
  if (are_there(parted)) return false;
  parted_.push_back(std::move(parted));
  return true;
}

void ObjectCommands::look_for_gone() {
  static_cast<void>(note_ended_attachments());
  attach_again();
}

bool ObjectCommands::are_there(const Parted& parted) const {
  const World& world = with_.loop.world();
  return world.find(parted.child) && world.find(parted.parent);
}

/// Restores attachments that a stop or a crash has separated, if the parent may still come back with its publisher.
/// After a crash the wait is limited, since the publisher was running; after a stop it is not, since the publisher may
/// be started later.
void ObjectCommands::attach_again() {
  if (parted_.empty()) return;
  const bool is_last_try = !with_.loop.recovering() && with_.durable->crashed();
  std::erase_if(parted_, [&](const Parted& parted) {
    if (!with_.durable->is_due(parted.ask.request)) return true;
    if (!are_there(parted) && !is_last_try) return false;
    answers_.answer_once_kept(parted.ask, [&] { return attach(parted.ask, Arguments(parted.ask.text)); });
    return true;
  });
}

}  // namespace collided::engine::service
