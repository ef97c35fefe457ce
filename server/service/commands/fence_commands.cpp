#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "idl/glob.hpp"
#include "idl/packed_fences.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/fence_commands.hpp"
#include "server/service/commands/fence_prism.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/world/fences/fence_outline.hpp"
#include "server/world/fences/fences.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/declared.hpp"
#include "server/world/solids/solid.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

std::uint8_t tells_of(const Arguments& arguments) {
  if (!arguments.has("tells")) return kTellsAll;
  std::uint8_t tells = 0;
  for (const std::string& word : arguments.texts("tells")) {
    const auto found = std::ranges::find_if(kTellsWords, [&](const auto& told) { return word == told.first; });
    if (found == std::end(kTellsWords))
      throw BadCommand(fmt::format("fence: 'tells' has {}; allowed: enter, exit, cross", printable(word)));
    tells |= found->second;
  }
  return tells;
}

json words_of(std::uint8_t tells) {
  json words = json::array();
  for (const auto& [word, bit] : kTellsWords) {
    if ((tells & bit) != 0) words.push_back(word);
  }
  return words;
}

/// [[x, y, z, x, y, z, ...], ...] in metres: what a picture shows of a fence, in its frame.
json lines_of(const FenceTable& table, std::uint32_t slot) {
  json lines = json::array();
  for (const Polyline& line :
       outline_of(table.described(slot), table.is_band(slot) ? table.rule(slot).band->within_m : 0)) {
    json numbers = json::array();
    for (const Vec3& point : line) {
      for (const double x : point) numbers.push_back(x + 0.0);
    }
    lines.push_back(std::move(numbers));
  }
  return lines;
}

/// Makes the definition's mesh, which must close, hold what it encloses.
void enclose(FenceDefinition& definition) {
  if (!definition.shape.mesh) return;
  DeclaredMesh declared = declare_solid_at_once(definition.shape.mesh);
  if (!declared.solid)
    throw BadCommand(fmt::format("fence {}: its mesh holds nothing: {}. Nothing was added", printable(definition.name),
                                 declared.refusal));
  definition.solid = std::move(declared.solid);
}

Shape prism_of(const Arguments& arguments) {
  const std::vector<double> list = arguments.numbers("prism");
  const auto wrong = [] {
    throw BadCommand("fence: 'prism' is [low, high, x, y, x, y, ...], in metres, with three corners or more");
  };
  if (list.size() < 8 || list.size() % 2 != 0) wrong();
  std::vector<std::array<double, 2>> corners;
  for (std::size_t i = 2; i < list.size(); i += 2) corners.push_back({list[i], list[i + 1]});
  auto made = upright_prism(corners, list[0], list[1]);
  if (const auto* refusal = std::get_if<Refusal>(&made))
    throw BadCommand(fmt::format("fence: {}. Nothing was added", refusal->reason));
  return {.primitives = {}, .mesh = std::get<std::shared_ptr<const TriangleMesh>>(made)};
}

FenceDefinition margin_of(const Arguments& arguments) {
  FenceDefinition margin{.name = arguments.text("name"),
                         .only = arguments.text("only"),
                         .skip = arguments.text("skip"),
                         .mask = arguments.whole_32("mask"),
                         .margin = MarginBands{.around = arguments.text("around"),
                                               .bands_m = arguments.numbers("bands"),
                                               .hysteresis_m = arguments.number("hysteresis")}};
  margin.margin->dwell_ns = static_cast<std::int64_t>(arguments.whole("dwell_ns"));
  if (!is_good_name(margin.name))
    throw BadCommand(
        fmt::format("margin: the name {} is empty, longer than 255 bytes or not text", printable(margin.name)));
  if (margin.margin->around.empty() || margin.only.empty())
    throw BadCommand(fmt::format("margin {}: two names or globs are needed, 'around' and 'only'. Nothing was added",
                                 printable(margin.name)));
  // Within all bands is who touches.
  if (margin.margin->bands_m.empty() || margin.margin->bands_m.back() != 0) margin.margin->bands_m.push_back(0);
  return margin;
}

FenceDefinition fence_of(const Arguments& arguments, std::span<const std::byte> shape_bytes) {
  if (arguments.has("bands")) return margin_of(arguments);
  if (arguments.has("within")) return nearest_of(arguments);
  FenceDefinition fence{.name = arguments.text("name"),
                        .carrier = arguments.text("to"),
                        .only = arguments.text("only"),
                        .skip = arguments.text("skip"),
                        .mask = arguments.whole_32("mask"),
                        .tells = tells_of(arguments)};
  if (!is_good_name(fence.name))
    throw BadCommand(
        fmt::format("fence: the name {} is empty, longer than 255 bytes or not text", printable(fence.name)));
  if (arguments.has("prism")) {
    fence.shape = prism_of(arguments);
  } else {
    DecodedShape decoded = decode_shape(shape_bytes);
    if (!decoded.shape) throw BadCommand("fence: " + decoded.refusal);
    fence.shape = std::move(*decoded.shape);
  }
  enclose(fence);
  return fence;
}

/// The fences of a message of many.
std::vector<CommandAsk> split(const CommandAsk& ask) {
  const auto packed = wire_contract::unpack_fences(ask.blob);
  if (!packed) throw BadCommand("fence: the message of many fences ends within one. Nothing was added");
  std::vector<CommandAsk> fences;
  for (const wire_contract::PackedFence& one : *packed) {
    fences.push_back({.client = ask.client,
                      .request = ask.request,
                      .text = std::string(one.arguments),
                      .blob = {one.shape.begin(), one.shape.end()},
                      .from = ask.from});
  }
  return fences;
}

}  // namespace

namespace {

/// Parts of loaded scenes that a margin's globs match, which have no bands.
std::uint64_t matching_parts(const FenceDefinition& margin, const Snapshot& state) {
  std::uint64_t count = 0;
  for (const auto& info : state.objects) {
    if (!info || info->scene_part == kNoScenePart) continue;
    const auto is_of = [&](const std::string& glob) { return wire_contract::glob_matches(glob, info->name); };
    if ((is_of(margin.margin->around) || is_of(margin.only)) && !(!margin.skip.empty() && is_of(margin.skip))) ++count;
  }
  return count;
}

}  // namespace

std::unique_ptr<CommandFamily> fence_commands(CommandContext& context) {
  return std::make_unique<FenceCommands>(context);
}

std::vector<BoundCommand> FenceCommands::commands() {
  return {on_world_thread(names::kFence, this, &FenceCommands::fence),
          on_world_thread(names::kFences, this, &FenceCommands::fences)};
}

json FenceCommands::fence(const CommandAsk& ask, const Arguments& arguments) {
  if (arguments.truth("remove")) return remove_fences(ask, arguments);
  std::vector<CommandAsk> asks;
  if (arguments.has("many")) {
    asks = split(ask);
  } else {
    asks.push_back(ask);
  }
  // All or nothing: recordings and servers that follow know a command as done or refused.
  std::vector<std::string> added;
  try {
    for (const CommandAsk& one : asks) {
      const Arguments own(one.text, names::kPackedFence);
      own.refuse_unknown();
      add_fence(one, own);
      added.push_back(own.text("name"));
    }
  } catch (const BadCommand& bad) {
    for (const std::string& name : added) with_.loop.world().remove_fence(name);
    if (asks.size() == 1) throw;
    throw BadCommand(fmt::format("fence {} of {} is refused, so none of them was added: {}", added.size() + 1,
                                 asks.size(), bad.what()),
                     bad.hint);
  }
  std::vector<std::pair<std::string, CommandAsk>> kept;
  for (std::size_t i = 0; i < asks.size(); ++i) {
    const bool is_kept = Arguments(asks[i].text).truth("keep");
    if (!is_kept) fence_owners_.insert(ask.client);
    else kept.emplace_back(added[i], asks[i]);
  }
  // Whoever moves something after the answer finds the fences there.
  if (!asks.empty()) step();
  if (with_.durable != nullptr) with_.durable->fences_set(kept);
  if (with_.changed && ask.client != 0) {
    for (const auto& [name, one] : kept) with_.changed(one);
  }
  if (asks.size() > 1) added.clear();
  json answer{{"fences", added}, {"count", asks.size()}, {"version", with_.loop.world().newest()->version}};
  if (arguments.has("bands")) {
    const std::uint64_t parts = matching_parts(margin_of(arguments), *with_.loop.world().newest());
    if (parts > 0) answer["parts"] = parts;
  }
  return answer;
}

void FenceCommands::add_fence(const CommandAsk& ask, const Arguments& arguments) {
  FenceDefinition definition = fence_of(arguments, ask.blob);
  if (!arguments.truth("keep")) definition.owner = ask.client;
  if (ask.from.peer && !ask.from.peer->may_name(definition.name))
    throw BadCommand(fmt::format("the keys of '{}' are not for fence {}. Nothing was added", ask.from.peer->name,
                                 printable(definition.name)));
  const auto added = with_.loop.world().add_fence(definition);
  if (const auto* refusal = std::get_if<Refusal>(&added)) throw BadCommand(refusal->reason);
}

json FenceCommands::remove_fences(const CommandAsk& ask, const Arguments& arguments) {
  const std::string glob = arguments.text("name");
  std::vector<std::string> chosen;
  if (arguments.truth("margins")) {
    for_each_margin(glob, [&](const FenceDefinition& margin) { chosen.push_back(margin.name); });
  } else {
    const bool is_nearest = arguments.truth("nearest");
    for_each_standing(glob, [&](const FenceTable& table, std::uint32_t slot) {
      if (table.is_nearest(slot) == is_nearest) chosen.push_back(table.name(slot));
    });
  }
  for (const std::string& name : chosen) refuse_if_foreign(ask, name, "removed");
  remove_fences(chosen);
  return {{"fences", chosen}, {"version", with_.loop.world().newest()->version}};
}

void FenceCommands::remove_fences(const std::vector<std::string>& chosen) {
  std::vector<std::string> kept;
  for (const std::string& name : chosen) {
    for_each_standing(name, [&](const FenceTable& table, std::uint32_t slot) {
      if (table.rule(slot).owner == 0) kept.push_back(name);
    });
    for_each_margin(name, [&](const FenceDefinition& margin) {
      if (margin.owner == 0) kept.push_back(name);
    });
    with_.loop.world().remove_fence(name);
  }
  if (with_.durable != nullptr) with_.durable->fences_removed(kept);
  if (!chosen.empty()) step();
}

void FenceCommands::look_for_gone() {
  std::set<std::uint64_t> gone;
  for (const std::uint64_t client : fence_owners_) {
    if (!answers_.answering().knows(client)) gone.insert(client);
  }
  if (gone.empty()) return;
  std::vector<std::string> chosen;
  for_each_standing("", [&](const FenceTable& table, std::uint32_t slot) {
    if (gone.contains(table.rule(slot).owner)) chosen.push_back(table.name(slot));
  });
  for_each_margin("", [&](const FenceDefinition& margin) {
    if (gone.contains(margin.owner)) chosen.push_back(margin.name);
  });
  remove_fences(chosen);
  for (const std::uint64_t client : gone) {
    fence_owners_.erase(client);
    answers_.answering().send_farewell(client);
  }
}

/// The same for fences alone.
void FenceCommands::for_each_fence(const std::string& glob, Visit visit) const {
  for_each_standing(glob, [&](const FenceTable& table, std::uint32_t slot) {
    if (!table.is_nearest(slot)) visit(table, slot);
  });
}

/// Calls visit(table, slot) for the fences and the questions for the nearest whose names match the glob, but not for
/// bands; a name without * ? [ is looked up.
void FenceCommands::for_each_standing(const std::string& glob, Visit visit) const {
  const Fences* fences = with_.loop.world().fences();
  if (fences == nullptr) return;
  const FenceTable& table = fences->table();
  if (!glob.empty() && glob.find_first_of("*?[") == std::string::npos) {
    if (const std::optional<std::uint32_t> slot = table.find(glob)) visit(table, *slot);
    return;
  }
  for (std::uint32_t slot = 0; slot < table.size(); ++slot) {
    if (table.holds(slot) && !table.is_band(slot) &&
        (glob.empty() || wire_contract::glob_matches(glob, table.name(slot))))
      visit(table, slot);
  }
}

/// The same for the bands of the margins of such a name, but for those of contact.
void FenceCommands::for_each_band(const std::string& glob, Visit visit) const {
  const FenceTable& table = with_.loop.world().fences()->table();
  for (std::uint32_t slot = 0; slot < table.size(); ++slot) {
    if (!table.holds(slot) || !table.is_band(slot) || table.rule(slot).band->within_m == 0) continue;
    if (glob.empty() || wire_contract::glob_matches(glob, table.rule(slot).band->margin)) visit(table, slot);
  }
}

void FenceCommands::for_each_margin(const std::string& glob,
                                    FunctionRef<void(const FenceDefinition& margin)> visit) const {
  const Fences* fences = with_.loop.world().fences();
  if (fences == nullptr) return;
  for (const auto& [name, margin] : fences->margins()) {
    if (glob.empty() || glob == name || wire_contract::glob_matches(glob, name)) visit(margin);
  }
}

json FenceCommands::margins(const Arguments& arguments) {
  struct NarrowestBand {
    std::string object;
    std::string around;
    double within_m = 0;
    bool is_in_doubt = false;
  };
  const World& world = with_.loop.world();
  // The narrowest band that each pair is in, by margin.
  std::map<std::string, std::map<std::pair<std::string, std::string>, NarrowestBand>> near;
  if (world.fences() != nullptr) {
    const FenceTable& table = world.fences()->table();
    for (const OpenContact& open : world.fences()->inside()) {
      const std::uint32_t slot = slot_of(open.b);
      const ObjectInfo* object = world.info(open.a);
      if (object == nullptr || !table.holds(slot) || table.id(slot) != open.b || !table.is_band(slot)) continue;
      const ObjectInfo* around = world.objects()[table.carrier(slot)].get();
      if (around == nullptr) continue;
      const NarrowestBand here{object->name, around->name, table.rule(slot).band->within_m, open.doubt != Doubt::none};
      const auto [known, is_new] = near[table.rule(slot).band->margin].try_emplace({here.around, here.object}, here);
      if (!is_new && here.within_m < known->second.within_m) known->second = here;
    }
  }
  json rows = json::array();
  for_each_margin(arguments.text("name"), [&](const FenceDefinition& margin) {
    json pairs = json::array();
    for (const auto& [names, here] : near[margin.name]) {
      pairs.push_back({{"object", here.object},
                       {"around", here.around},
                       {"within", here.within_m},
                       {"in_doubt", here.is_in_doubt}});
    }
    rows.push_back({{"margin", margin.name},
                    {"around", margin.margin->around},
                    {"only", margin.only},
                    {"skip", margin.skip},
                    {"mask", margin.mask},
                    {"bands", margin.margin->bands_m},
                    {"hysteresis", margin.margin->hysteresis_m},
                    {"dwell_ns", margin.margin->dwell_ns},
                    {"keep", margin.owner == 0},
                    {"pairs", std::move(pairs)}});
  });
  return {{"margins", rows}, {"count", rows.size()}, {"version", world.newest()->version}};
}

json FenceCommands::fences(const Arguments& arguments) {
  constexpr std::uint64_t kMostOutlines = 1'000;
  if (arguments.truth("margins")) return margins(arguments);
  if (arguments.truth("nearest")) return nearest(arguments);
  const World& world = with_.loop.world();
  const bool with_outlines = arguments.truth("outlines");
  const bool with_bands = arguments.truth("bands");
  const std::uint64_t limit = with_outlines ? arguments.whole("limit", kMostOutlines) : arguments.whole("limit");
  std::map<ObjectId, json> inside;
  std::map<ObjectId, json> in_doubt;
  if (world.fences() != nullptr) {
    for (const OpenContact& open : world.fences()->inside()) {
      const ObjectInfo* info = world.info(open.a);
      if (info != nullptr) (open.doubt == Doubt::none ? inside : in_doubt)[open.b].push_back(info->name);
    }
  }
  json rows = json::array();
  std::uint64_t count = 0;
  const auto describe = [&](const FenceTable& table, std::uint32_t slot) {
    if (count++ >= limit) return;
    const FenceRule& rule = table.rule(slot);
    const ObjectInfo body = table.described(slot);
    json row{{"fence", table.name(slot)}, {"id", table.id(slot)},
             {"kind", kind_of(body)},     {"to", rule.carrier},
             {"only", rule.only},         {"skip", rule.skip},
             {"mask", rule.mask},         {"tells", words_of(rule.tells)},
             {"keep", rule.owner == 0},   {"inside", json::array()},
             {"in_doubt", json::array()}};
    if (const auto here = inside.find(table.id(slot)); here != inside.end()) row["inside"] = here->second;
    if (const auto here = in_doubt.find(table.id(slot)); here != in_doubt.end()) row["in_doubt"] = here->second;
    if (with_outlines) row["lines"] = lines_of(table, slot);
    if (rule.band) {
      row["margin"] = rule.band->margin;
      row["within"] = rule.band->within_m;
      row["around"] = rule.band->around;
      row["hysteresis"] = rule.band->hysteresis_m;
      row["dwell_ns"] = rule.band->dwell_in_ns;
      const ObjectInfo* about = table.is_carried(slot) && table.carrier(slot) != FenceTable::kNone
                                    ? world.objects()[table.carrier(slot)].get()
                                    : nullptr;
      row["to"] = about != nullptr ? about->name : "";
    }
    rows.push_back(std::move(row));
  };
  for_each_fence(arguments.text("name"), describe);
  if (with_bands && world.fences() != nullptr) for_each_band(arguments.text("name"), describe);
  const std::size_t bytes = world.fences() != nullptr ? world.fences()->table().bytes() : 0;
  return {{"fences", rows}, {"count", count}, {"bytes", bytes}, {"version", world.newest()->version}};
}

}  // namespace collided::engine::service
