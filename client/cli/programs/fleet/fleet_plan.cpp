#include "client/cli/programs/fleet/fleet_plan.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/programs/fleet/kept_maps.hpp"
#include "client/cli/programs/fleet/shard_planning.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

using nlohmann::json;
using shards::ShardMap;
using shards::ShardMapError;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kMostListed = 1'000'000;

LoadMeasure load_measure_of(const std::string& word) {
  if (word.empty() || word == "moving") return LoadMeasure::moving;
  if (word == "objects") return LoadMeasure::objects;
  if (word == "triangles") return LoadMeasure::triangles;
  throw bad_use(fmt::format("--by {}: nothing that is counted", word), "moving, objects or triangles");
}

std::string_view word_for(LoadMeasure measure) {
  switch (measure) {
    case LoadMeasure::moving: return "moving";
    case LoadMeasure::objects: return "objects";
    case LoadMeasure::triangles: return "triangles";
  }
  return "";
}

/// Nothing: it has no extent anywhere.
std::optional<shards::ShardBox> shard_box_of(const json& bounds) {
  if (!bounds.is_array() || bounds.size() != 2) return std::nullopt;
  shards::ShardBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const json& low = bounds[0].at(axis);
    const json& high = bounds[1].at(axis);
    box.low[axis] = low.is_number() ? low.get<double>() : -kEndless;
    box.high[axis] = high.is_number() ? high.get<double>() : kEndless;
  }
  return box;
}

/// By name: near a border several shards hold an object.
using HeldByName = std::map<std::string, HeldObject>;

void add_objects(Session& session, const Globals& globals, HeldByName& held) {
  const json answer =
      server_command(session, globals, wire_contract::command::kList, {{"bounds", true}, {"limit", kMostListed}});
  for (const json& object : answer.value("objects", json::array())) {
    const auto box = shard_box_of(object.value("bounds", json()));
    if (!box) continue;
    held.insert_or_assign(
        text_of(object, "name"),
        HeldObject{.bounds = *box, .triangles = count_of(object, "triangles"), .moving = flag_of(object, "moving")});
  }
}

std::vector<HeldObject> listed(const HeldByName& held) {
  std::vector<HeldObject> objects;
  for (const auto& [name, object] : held) objects.push_back(object);
  return objects;
}

/// Unused names: "west_1" for "west".
std::vector<std::string> new_names(const std::string& stem, std::size_t count, const ShardMap* taken) {
  std::vector<std::string> names;
  for (std::size_t number = 1; names.size() < count; ++number) {
    std::string name = stem + std::to_string(number);
    if (taken == nullptr || !taken->find(name)) names.push_back(std::move(name));
  }
  return names;
}

std::size_t count_of_boxes(const std::string& into, std::size_t usual) {
  if (into.empty()) return usual;
  const std::uint64_t count = parse_count(into, 2);
  if (count > ShardMap::kMostShards)
    throw bad_use(fmt::format("--into {}: a map has at most {} shards", into, ShardMap::kMostShards));
  return static_cast<std::size_t>(count);
}

ShardPlan plan_of_server(Session& session, const Globals& globals, const FleetPlanOptions& options,
                         LoadMeasure measure) {
  if (!options.split.empty()) throw bad_use("--split names a shard of a map", "give the map: --shards FILE");
  const double margin_m = options.margin.empty() ? 1 : parse_finite(options.margin, Measure::length);
  if (margin_m < ShardMap::kLeastMarginM) throw bad_use(fmt::format("--margin {}: at least 1 mm", options.margin));
  const std::vector<std::string> names = new_names("s", count_of_boxes(options.into, 2), nullptr);
  HeldByName held;
  add_objects(session, globals, held);
  const shards::ShardBox everywhere{.low = {-kEndless, -kEndless, -kEndless}, .high = {kEndless, kEndless, kEndless}};
  const ShardMap whole = ShardMap::of(margin_m, {{.name = "whole", .box = everywhere}});
  return split_shard_box(whole, 0, names, listed(held), measure);
}

std::size_t chosen_shard(const ShardMap& map, const std::string& name, const std::vector<HeldObject>& objects,
                         LoadMeasure measure) {
  if (!name.empty()) {
    if (const auto place = map.find(name)) return *place;
    throw bad_use(fmt::format("--split {}: the map has no such shard", name));
  }
  const std::vector<ExpectedLoad> loads = expected_loads(map, objects);
  const auto heaviest =
      std::ranges::max_element(loads, {}, [&](const ExpectedLoad& load) { return load_of(load, measure); });
  return static_cast<std::size_t>(heaviest - loads.begin());
}

ShardPlan plan_of_shards(Session& session, const Globals& globals, const FleetPlanOptions& options,
                         LoadMeasure measure) {
  if (!options.margin.empty()) throw bad_use("--margin is that of the map, which --shards names");
  const ShardMap map = take_map(globals.shards, map_access(session.io, globals)).map;
  HeldByName held;
  for (std::size_t place = 0; place < map.size(); ++place) {
    Globals of_shard = globals;
    of_shard.name_space = shards::shard_namespace(connect_options(session.io, globals).name_space, map.at(place).name);
    of_shard.shards.clear();
    // One connection after the other: a session has only one.
    Session alone(session.io, session.own);
    add_objects(alone, of_shard, held);
  }
  const std::vector<HeldObject> objects = listed(held);
  const std::size_t split = chosen_shard(map, options.split, objects, measure);
  const std::vector<std::string> names = new_names(map.at(split).name + '_', count_of_boxes(options.into, 2), &map);
  return split_shard_box(map, split, names, objects, measure);
}

std::string box_text(const shards::ShardBox& box) {
  return fmt::format("{} {} {} .. {} {} {}", box.low[0], box.low[1], box.low[2], box.high[0], box.high[1], box.high[2]);
}

void print_loads(Session& session, const Globals& globals, const ShardPlan& plan) {
  static const std::vector<std::string> kHeader{"SHARD", "BOX", "MOVING", "OBJECTS", "TRIANGLES"};
  Printer printer = make_printer(session.io, globals);
  printer.set_usual_fields({"shard", "moving", "objects", "triangles"});
  for (std::size_t place = 0; place < plan.map.size(); ++place) {
    const shards::ShardEntry& shard = plan.map.at(place);
    const ExpectedLoad& load = plan.loads[place];
    if (printer.human()) {
      printer.row(kHeader, {shard.name, box_text(shard.box), format_count(load.moving), format_count(load.objects),
                            format_count(load.triangles)});
      continue;
    }
    printer.record({{"shard", shard.name},
                    {"moving", load.moving},
                    {"objects", load.objects},
                    {"triangles", load.triangles},
                    {"low", MaybeVector(Eigen::Vector3d(shard.box.low.data()))},
                    {"high", MaybeVector(Eigen::Vector3d(shard.box.high.data()))}});
  }
  printer.finish();
}

void print_summary(Session& session, const Globals& globals, const ShardPlan& plan, LoadMeasure measure) {
  std::string loads;
  for (std::size_t place = 0; place < plan.map.size(); ++place)
    loads +=
        fmt::format("{}{} {}", place == 0 ? "" : ", ", plan.map.at(place).name, load_of(plan.loads[place], measure));
  print_hint(session.io, globals,
             fmt::format("{}: {}; {} of {} in more than one shard", word_for(measure), loads, plan.objects_in_many,
                         counted(plan.objects, "object")));
}

/// The successor of a map in etcd is only a proposal at first, so a newer one replaces it.
void write_proposal(Session& session, const Globals& globals, const std::string& target, const ShardMap& map) {
  const shards::MapAccess access = map_access(session.io, globals);
  std::int64_t in_place_of = 0;
  if (target == globals.shards + "/next") in_place_of = revision_at(target, access);
  write_map(map, target, in_place_of, access);
}

}  // namespace

Exit plan_shards(Session& session, const Globals& globals, const FleetPlanOptions& options) {
  const LoadMeasure measure = load_measure_of(options.by);
  try {
    const ShardPlan plan = globals.shards.empty() ? plan_of_server(session, globals, options, measure)
                                                  : plan_of_shards(session, globals, options, measure);
    if (options.out.empty()) {
      session.io.out << plan.map.text();
    } else {
      write_proposal(session, globals, options.out, plan.map);
      print_loads(session, globals, plan);
    }
    print_summary(session, globals, plan, measure);
    return Exit::yes;
  } catch (const ShardMapError& wrong) {
    throw Failure(Exit::no, wrong.what(),
                  measure == LoadMeasure::moving ? "--by objects or --by triangles count another load" : "");
  }
}

}  // namespace collided::cli
