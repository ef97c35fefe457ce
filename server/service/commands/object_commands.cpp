#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "idl/described_json.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/object_commands.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/query/query.hpp"
#include "server/world/solids/declared.hpp"

// Objects: lists them, and adds and moves them by command.
namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

std::vector<BoundCommand> ObjectCommands::commands() {
  return {on_asking_thread(names::kList, this, &ObjectCommands::list),
          on_world_thread(names::kGet, this, &ObjectCommands::get),
          on_world_thread(names::kLeftOut, this, &ObjectCommands::left_out),
          on_world_thread(names::kAdd, this, &ObjectCommands::add),
          on_world_thread(names::kMove, this, &ObjectCommands::move),
          on_world_thread(names::kRemove, this, &ObjectCommands::remove),
          on_world_thread(names::kClear, this, &ObjectCommands::clear),
          on_world_thread(names::kAttach, this, &ObjectCommands::attach),
          on_world_thread(names::kDetach, this, &ObjectCommands::detach)};
}

/// The object of that name; the newest snapshot then has a row of it.
ObjectId ObjectCommands::find_object(const std::string& name) const {
  if (const std::optional<ObjectId> id = with_.loop.world().find(name)) {
    // Defined since the last step: a step puts it into the snapshot.
    const SnapshotRing::Lease state = with_.loop.world().newest();
    if (state->objects.find(*id) == nullptr) with_.loop.step_now();
    return *id;
  }
  std::vector<std::string_view> others;
  for (const auto& info : with_.loop.world().objects()) {
    if (info) others.push_back(info->name);
  }
  throw BadCommand(unknown_object(name, others));
}

void ObjectCommands::refuse_if_live(const ObjectInfo& info) const {
  if (info.publisher == 0 || !with_.loop.publishers().is_live(info.publisher)) return;
  throw BadCommand(fmt::format("object {} belongs to publisher {}, which lives", printable(info.name),
                               printable(with_.loop.publisher_name(info.publisher))),
                   "its publisher moves and removes it");
}

json ObjectCommands::list(const Arguments& arguments) const {
  const bool has_bounds = arguments.truth("bounds");
  const std::string glob = arguments.text("name");
  const std::optional<bool> moving = arguments.truth_if_given("moving");
  const std::uint64_t limit = arguments.whole("limit");
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json objects = json::array();
  std::uint64_t count = 0;
  for (const auto& info : state->objects) {
    if (!info || (moving && info->moving != *moving)) continue;
    if (!glob.empty() && !glob_matches(glob, info->name)) continue;
    if (count++ >= limit) continue;
    objects.push_back(json_of(listed_object(*state, *info, with_.loop.publisher_name(info->publisher))));
    if (has_bounds) objects.back()["bounds"] = bounds_of(*state, *info);
  }
  return {{"objects", objects}, {"count", count}, {"version", state->version}};
}

json ObjectCommands::get(const Arguments& arguments) {
  const ObjectInfo& info = *with_.loop.world().info(find_object(arguments.text("name")));
  const SnapshotRing::Lease state = with_.loop.world().newest();
  ObjectDetails details = object_details(*state, info, with_.loop.publisher_name(info.publisher), with_.clock.now_ns());
  json in_doubt = json::array();
  for (const OpenContact& contact : with_.loop.world().contacts()) {
    if (contact.a != info.id && contact.b != info.id) continue;
    const ObjectInfo* other = with_.loop.world().info(contact.a == info.id ? contact.b : contact.a);
    if (other == nullptr) continue;
    if (contact.doubt == Doubt::none) details.contacts.push_back(other->name);
    else in_doubt.push_back(other->name);
  }
  json object = json_of(details);
  object["shape"] = shape_of(info);
  object["bounds"] = bounds_of(*state, info);
  if (const auto velocity = with_.loop.publishers().velocity(info.id)) object["velocity"] = *velocity;
  if (!in_doubt.empty()) object["in_doubt"] = in_doubt;
  json waiting = json::array();
  for (const std::uint64_t publisher : with_.loop.publishers().waiting_for(info.name))
    waiting.push_back(with_.loop.publisher_name(publisher));
  if (!waiting.empty()) object["name_wanted_by"] = waiting;
  object["version"] = state->version;
  return object;
}

/// Objects that a publisher has sent and the world lacks.
json ObjectCommands::left_out(const Arguments& arguments) {
  constexpr std::size_t kMost = 20;
  const std::uint64_t publisher = arguments.whole("publisher");
  json objects = json::array();
  for (const Publishers::LeftOut& object : with_.loop.publishers().left_out(publisher, kMost))
    objects.push_back({{"name", object.name}, {"why", object.why}});
  json answer{{"objects", objects},
              {"count", with_.loop.publishers().left_out_count(publisher)},
              {"merged", with_.loop.publishers().merged_poses(publisher)},
              {"version", with_.loop.world().newest()->version}};
  if (std::string why = with_.why_refused ? with_.why_refused(publisher) : std::string(); !why.empty())
    answer["refused"] = std::move(why);
  return answer;
}

namespace {

/// Makes the object's mesh solid; returns a warning, or nothing. Throws BadCommand if it bounds no solid.
/// Primitives are solid without it.
std::string declare_solid(ObjectDefinition& definition, SolidBy by) {
  if (!definition.shape.mesh) return {};
  DeclaredMesh declared = declare_solid_at_once(definition.shape.mesh, by);
  if (!declared.solid && !declared.winding)
    throw BadCommand(
        fmt::format("add: {} is not solid: {}. Nothing was added", printable(definition.name), declared.refusal),
        "without --solid it is a surface; --solid=winding decides by winding number; collide check FILE says more");
  definition.indexed = std::move(declared.indexed);
  definition.solid = std::move(declared.solid);
  definition.winding = std::move(declared.winding);
  return declared.warning;
}

}  // namespace

json ObjectCommands::add(const CommandAsk& ask, const Arguments& arguments) {
  const Filter filter{
      .layers = arguments.whole_32("layers"), .mask = arguments.whole_32("mask"), .group = arguments.whole_32("group")};
  const std::string name = arguments.text("name");
  if (!is_good_name(name))
    throw BadCommand(fmt::format("add: the name {} is empty, longer than 255 bytes or not text", printable(name)));
  DecodedShape decoded = decode_shape(ask.blob);
  if (!decoded.shape) throw BadCommand("add: " + decoded.refusal);
  if (decoded.shape->empty()) throw BadCommand("add: the shape is empty");
  // Scaled here, on the way in: a shape in the world has no factors.
  if (const std::optional<Vec3> factor = arguments.vector("scale"); factor && *factor != Vec3::Ones()) {
    if (const std::string reason = scale(*decoded.shape, *factor); !reason.empty()) throw BadCommand("add: " + reason);
  }
  ObjectDefinition definition{.name = name,
                              .scene = {},
                              .shape = std::move(*decoded.shape),
                              .pose = arguments.pose("pose").value_or(Pose{}),
                              .filter = filter,
                              .moving = arguments.truth("moving")};
  std::string warning;
  const SolidBy by = arguments.is_solid_by_winding() ? SolidBy::winding : SolidBy::closing;
  if (arguments.truth("solid")) warning = declare_solid(definition, by);
  const std::variant<ObjectId, Refusal> defined = with_.loop.world().define(definition);
  if (const auto* refusal = std::get_if<Refusal>(&defined)) throw BadCommand(refusal->reason);
  keep({KeptKind::object, name}, ask);
  json answer = json_of(Added{.id = std::get<ObjectId>(defined), .version = step(), .warning = warning});
  answer["name"] = name;
  return answer;
}

/// Stores the last pose of an object of a scene, or of one that a command has added. An object left by a lost publisher
/// goes with the publisher, and so does its pose.
void ObjectCommands::keep_moved(const ObjectInfo& info, const CommandAsk& ask) {
  const std::string& scene = info.rare->scene;
  if (info.publisher != 0) return keep({KeptKind::published, info.name}, ask, info.publisher);
  keep(scene.empty() ? KeptKey{KeptKind::moved, info.name}
                     : KeptKey::of_member(KeptKind::member_moved, scene, info.name),
       ask);
}

json ObjectCommands::move(const CommandAsk& ask, const Arguments& arguments) {
  World& world = with_.loop.world();
  const std::string name = arguments.text("name");
  const std::optional<Pose> pose = arguments.pose("pose");
  if (!pose) throw BadCommand("move: without a pose", "a pose is [x, y, z, qw, qx, qy, qz]");
  const bool teleport = arguments.truth("teleport");
  const ObjectId id = find_object(name);
  refuse_if_live(*world.info(id));
  if (const AttachedObject* attached = world.attachments().find(id))
    throw BadCommand(
        fmt::format("object {} is attached to {}, which moves it", printable(name), printable(attached->parent_name)),
        "collide detach " + name);
  // A step examines one motion of an object only, so an earlier one is examined first.
  if (world.has_moved(id)) with_.loop.step_now();
  const Vec3 before = world.newest()->poses[slot_of(id)].position;
  if (!world.move(id, *pose, with_.clock.now_ns(), teleport)) {
    throw BadCommand(fmt::format("object {} is a part of scene {} and stays where it is", printable(name),
                                 printable(world.info(id)->rare->scene)));
  }
  const ObjectInfo& info = *world.info(id);
  // When repeated, the object is placed, not moved: its motion ended before the crash.
  json again = json::parse(ask.text);
  again["teleport"] = true;
  keep_moved(info, {0, 0, again.dump(), {}});
  Moved moved{.distance_m = (pose->position - before).norm(), .began = {}, .ended = {}, .version = step()};
  for (const Event& event : world.events()) {
    if (event.of.a != id && event.of.b != id) continue;
    const ObjectInfo* other = world.info(event.of.a == id ? event.of.b : event.of.a);
    if (event.kind == EventKind::began) moved.began.push_back(other ? other->name : std::string());
    if (event.kind == EventKind::ended) moved.ended.push_back(other ? other->name : std::string());
  }
  json answer = json_of(moved);
  answer["name"] = name;
  return answer;
}

}  // namespace collided::engine::service
