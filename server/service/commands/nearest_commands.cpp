// Questions that stay for the nearest object, as commands define, list and remove them: a kind of fence.
#include <fmt/format.h>

#include <map>

#include "server/service/commands/fence_commands.hpp"
#include "idl/described_json.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {

using nlohmann::json;

FenceDefinition nearest_of(const Arguments& arguments) {
  FenceDefinition asked{
      .name = arguments.text("name"),
      .carrier = arguments.text("to"),
      .only = arguments.text("only"),
      .skip = arguments.text("skip"),
      .mask = arguments.whole_32("mask"),
      .nearest = NearestRule{.within_m = arguments.number("within"), .hysteresis_m = arguments.number("hysteresis")}};
  if (!is_good_name(asked.name))
    throw BadCommand(
        fmt::format("nearest: the name {} is empty, longer than 255 bytes or not text", printable(asked.name)));
  const std::optional<Vec3> point = arguments.vector("point");
  if (point.has_value() != asked.carrier.empty())
    throw BadCommand(fmt::format("nearest {}: an object, 'to', or a point is needed, and not both. Nothing was added",
                                 printable(asked.name)));
  if (asked.only.empty())
    throw BadCommand(fmt::format("nearest {}: the name or glob of the objects is needed, 'only'. Nothing was added",
                                 printable(asked.name)));
  if (point && !point->allFinite())
    throw BadCommand(fmt::format("nearest {}: the point is not finite. Nothing was added", printable(asked.name)));
  asked.shape.primitives.emplace_back(Sphere{point.value_or(Vec3::Zero()), 0});
  return asked;
}

json FenceCommands::nearest(const Arguments& arguments) {
  const World& world = with_.loop.world();
  const std::uint64_t limit = arguments.whole("limit");
  std::map<ObjectId, const OpenContact*> open_of;
  if (world.fences() != nullptr) {
    for (const OpenContact& open : world.fences()->inside()) open_of[open.b] = &open;
  }
  json rows = json::array();
  std::uint64_t count = 0;
  for_each_standing(arguments.text("name"), [&](const FenceTable& table, std::uint32_t slot) {
    if (!table.is_nearest(slot) || count++ >= limit) return;
    const FenceRule& rule = table.rule(slot);
    json row{{"nearest", table.name(slot)},
             {"to", rule.carrier},
             {"only", rule.only},
             {"skip", rule.skip},
             {"mask", rule.mask},
             {"within", rule.nearest->within_m},
             {"hysteresis", rule.nearest->hysteresis_m},
             {"keep", rule.owner == 0},
             {"object", ""},
             {"cut_short", world.fences()->cut_short(slot)},
             {"in_doubt", false}};
    if (rule.carrier.empty()) row["point"] = json_of(std::get<Sphere>(table.described(slot).primitives.front()).center);
    const auto open = open_of.find(table.id(slot));
    const ObjectInfo* info = open == open_of.end() ? nullptr : world.info(open->second->a);
    if (info != nullptr) {
      row["object"] = info->name;
      row["since_ns"] = open->second->began_ns;
      row["in_doubt"] = open->second->doubt != Doubt::none;
    }
    rows.push_back(std::move(row));
  });
  return {{"nearest", rows}, {"count", count}, {"version", world.newest()->version}};
}

}  // namespace collided::engine::service
