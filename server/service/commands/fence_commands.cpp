#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "idl/commands.hpp"
#include "idl/glob.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/commands/fence_prism.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/fences/fences.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/solids/solid.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

constexpr std::array<std::pair<const char*, FenceTells>, 3> kTold{
    {{"enter", kEnter}, {"exit", kExit}, {"cross", kCross}}};

std::uint8_t tells_of(const Arguments& arguments) {
  if (!arguments.has("tells")) return kTellsAll;
  std::uint8_t tells = 0;
  for (const std::string& word : arguments.texts("tells")) {
    const auto found = std::find_if(kTold.begin(), kTold.end(), [&](const auto& told) { return word == told.first; });
    if (found == kTold.end())
      throw BadCommand(fmt::format("fence: 'tells' has {}; allowed: enter, exit, cross", printable(word)));
    tells |= found->second;
  }
  return tells;
}

json words_of(std::uint8_t tells) {
  json words = json::array();
  for (const auto& [word, bit] : kTold) {
    if ((tells & bit) != 0) words.push_back(word);
  }
  return words;
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

FenceDefinition fence_of(const Arguments& arguments, std::span<const std::byte> shape_bytes) {
  constexpr std::uint64_t kBits = 0xffffffff;
  arguments.allow_only({"name", "only", "skip", "mask", "tells", "to", "prism", "keep", "durable"});
  FenceDefinition fence{.name = arguments.text("name"),
                        .carrier = arguments.text("to"),
                        .only = arguments.text("only"),
                        .skip = arguments.text("skip"),
                        .mask = static_cast<std::uint32_t>(arguments.whole("mask", kBits, kBits)),
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

/// The fences of a message of many: each is the length of its arguments, 4 bytes with the lowest first, these, the
/// length of its shape, and that.
std::vector<CommandAsk> split(const CommandAsk& ask) {
  std::vector<CommandAsk> fences;
  std::span<const std::byte> rest = ask.blob;
  const auto take = [&] {
    if (rest.size() < 4) throw BadCommand("fence: the message of many fences ends within one. Nothing was added");
    std::uint32_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size |= std::to_integer<std::uint32_t>(rest[i]) << (8 * i);
    if (rest.size() - 4 < size)
      throw BadCommand("fence: the message of many fences ends within one. Nothing was added");
    const std::span<const std::byte> taken = rest.subspan(4, size);
    rest = rest.subspan(4 + size);
    return taken;
  };
  while (!rest.empty()) {
    const std::span<const std::byte> text = take();
    const std::span<const std::byte> shape = take();
    fences.push_back({.client = ask.client,
                      .request = ask.request,
                      .text = std::string(reinterpret_cast<const char*>(text.data()), text.size()),
                      .blob = {shape.begin(), shape.end()},
                      .from = ask.from});
  }
  return fences;
}

}  // namespace

json Commands::fence(const CommandAsk& ask, const Arguments& arguments) {
  if (arguments.truth("remove", false)) return remove_fences(ask, arguments);
  std::vector<CommandAsk> asks;
  if (arguments.has("many")) {
    arguments.allow_only({"many", "durable"});
    asks = split(ask);
  } else {
    asks.push_back(ask);
  }
  std::vector<std::pair<std::string, CommandAsk>> kept;
  std::size_t done = 0;
  const auto keep = [&] {
    // Whoever moves something after the answer finds the fence there.
    if (done > 0) step();
    if (with_.durable != nullptr) with_.durable->fences_set(kept);
  };
  json added = json::array();
  try {
    for (; done < asks.size(); ++done) {
      const Arguments own(asks[done].text);
      add_fence(asks[done], own);
      if (asks.size() == 1) added.push_back(own.text("name"));
      if (own.truth("keep", false)) kept.emplace_back(own.text("name"), asks[done]);
    }
  } catch (const BadCommand& bad) {
    keep();
    if (asks.size() == 1) throw;
    throw BadCommand(
        fmt::format("fence {} of {}: {}. The {} before it were added", done + 1, asks.size(), bad.what(), done),
        bad.hint);
  }
  keep();
  return {{"fences", added}, {"count", asks.size()}, {"version", with_.loop.world().newest()->version}};
}

void Commands::add_fence(const CommandAsk& ask, const Arguments& arguments) {
  FenceDefinition definition = fence_of(arguments, ask.blob);
  const bool is_kept = arguments.truth("keep", false);
  if (!is_kept) definition.owner = ask.client;
  if (ask.from.peer && !ask.from.peer->may_name(definition.name))
    throw BadCommand(fmt::format("the keys of '{}' are not for fence {}. Nothing was added", ask.from.peer->name,
                                 printable(definition.name)));
  const auto added = with_.loop.world().add_fence(definition);
  if (const auto* refusal = std::get_if<Refusal>(&added)) throw BadCommand(refusal->reason);
  if (!is_kept) fence_owners_.insert(ask.client);
}

json Commands::remove_fences(const CommandAsk& ask, const Arguments& arguments) {
  arguments.allow_only({"name", "remove", "durable"});
  const std::string glob = arguments.text("name");
  std::vector<std::string> chosen;
  for_each_fence(glob, [&](const FenceTable& table, std::uint32_t slot) { chosen.push_back(table.name(slot)); });
  for (const std::string& name : chosen) refuse_if_foreign(ask, name, "removed");
  remove_fences(chosen);
  return {{"fences", chosen}, {"version", with_.loop.world().newest()->version}};
}

void Commands::remove_fences(const std::vector<std::string>& chosen) {
  std::vector<std::string> kept;
  for (const std::string& name : chosen) {
    for_each_fence(name, [&](const FenceTable& table, std::uint32_t slot) {
      if (table.rule(slot).owner == 0) kept.push_back(name);
    });
    with_.loop.world().remove_fence(name);
  }
  if (with_.durable != nullptr) with_.durable->fences_removed(kept);
  if (!chosen.empty()) step();
}

/// Removes the fences of clients that have gone.
void Commands::drop_fences_of_gone() {
  std::set<std::uint64_t> gone;
  for (const std::uint64_t client : fence_owners_) {
    if (!answering_->knows(client)) gone.insert(client);
  }
  if (gone.empty()) return;
  std::vector<std::string> chosen;
  for_each_fence("", [&](const FenceTable& table, std::uint32_t slot) {
    if (gone.contains(table.rule(slot).owner)) chosen.push_back(table.name(slot));
  });
  remove_fences(chosen);
  for (const std::uint64_t client : gone) fence_owners_.erase(client);
}

/// Calls visit(table, slot) for the fences whose names match the glob; a name without * ? [ is looked up.
void Commands::for_each_fence(const std::string& glob,
                              FunctionRef<void(const FenceTable& table, std::uint32_t slot)> visit) const {
  const Fences* fences = with_.loop.world().fences();
  if (fences == nullptr) return;
  const FenceTable& table = fences->table();
  if (!glob.empty() && glob.find_first_of("*?[") == std::string::npos) {
    if (const std::optional<std::uint32_t> slot = table.find(glob)) visit(table, *slot);
    return;
  }
  for (std::uint32_t slot = 0; slot < table.size(); ++slot) {
    if (table.holds(slot) && (glob.empty() || wire_contract::glob_matches(glob, table.name(slot)))) visit(table, slot);
  }
}

json Commands::fences(const CommandAsk&, const Arguments& arguments) {
  arguments.allow_only({"name", "limit"});
  const World& world = with_.loop.world();
  const std::uint64_t limit = arguments.whole("limit", 10'000, 1'000'000);
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
  for_each_fence(arguments.text("name"), [&](const FenceTable& table, std::uint32_t slot) {
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
    rows.push_back(std::move(row));
  });
  const std::size_t bytes = world.fences() != nullptr ? world.fences()->table().bytes() : 0;
  return {{"fences", rows}, {"count", count}, {"bytes", bytes}, {"version", world.newest()->version}};
}

}  // namespace collided::engine::service
