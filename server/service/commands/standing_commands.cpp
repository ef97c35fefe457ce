#include "server/service/commands/standing_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "idl/answers/standing.hpp"
#include "idl/described_json.hpp"
#include "idl/glob.hpp"
#include "idl/packed_fences.hpp"
#include "server/service/commands/standing_definition.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/explain/standing_explanation.hpp"
#include "server/world/fences/fence_outline.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

/// Nothing: every form.
std::optional<StandingForm> asked_form(const Arguments& arguments) {
  const std::string word = arguments.text("form");
  if (word.empty()) return std::nullopt;
  for (const StandingForm form : {StandingForm::region, StandingForm::bands, StandingForm::nearest}) {
    if (word == name_of(form)) return form;
  }
  throw BadCommand(fmt::format("'form' is {}; allowed: region, bands, nearest", printable(word)));
}

/// Polylines of a picture, in its frame.
std::vector<std::vector<double>> lines_of(const FenceTable& table, std::uint32_t slot) {
  std::vector<std::vector<double>> lines;
  for (const Polyline& line :
       outline_of(table.described(slot), table.is_band(slot) ? table.rule(slot).band->within_m : 0)) {
    std::vector<double>& numbers = lines.emplace_back();
    for (const Vec3& point : line) numbers.insert(numbers.end(), {point.x(), point.y(), point.z()});
  }
  return lines;
}

/// The questions of a message of many.
std::vector<CommandAsk> split(const CommandAsk& ask) {
  const auto packed = wire_contract::unpack_fences(ask.blob);
  if (!packed) throw BadCommand("fence: the message of many ends within one. Nothing was added");
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

/// Parts of loaded scenes that the globs of bands match; they have no bands.
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

std::unique_ptr<CommandFamily> standing_commands(CommandContext& context) {
  return std::make_unique<StandingCommands>(context);
}

std::vector<BoundCommand> StandingCommands::commands() {
  return {on_world_thread(names::kFence, this, &StandingCommands::add_or_remove),
          on_world_thread(names::kFences, this, &StandingCommands::list)};
}

json StandingCommands::add_or_remove(const CommandAsk& ask, const Arguments& arguments) {
  if (arguments.truth("remove")) return remove(ask, arguments);
  std::vector<CommandAsk> asks;
  if (arguments.has("many")) {
    asks = split(ask);
  } else {
    asks.push_back(ask);
  }
  // All or nothing: recordings and followers know a command as done or refused.
  std::vector<std::string> added;
  try {
    for (const CommandAsk& one : asks) {
      const Arguments own(one.text, names::kPackedFence);
      own.refuse_unknown();
      add(one, own);
      added.push_back(own.text("name"));
    }
  } catch (const BadCommand& bad) {
    for (const std::string& name : added) with_.loop.world().remove_fence(name);
    if (asks.size() == 1) throw;
    throw BadCommand(fmt::format("fence {} of {} is refused, so none of them was added: {}", added.size() + 1,
                                 asks.size(), bad.what()),
                     bad.hint);
  }
  for (std::size_t i = 0; i < asks.size(); ++i) {
    const bool is_kept = Arguments(asks[i].text).truth("keep");
    if (!is_kept) owners_.insert(ask.client);
    keep({KeptKind::fence, added[i]}, asks[i], is_kept ? 0 : ask.client);
  }
  // A client that moves something after the answer finds the fences in place.
  if (!asks.empty()) step();
  if (asks.size() > 1) added.clear();
  json answer{{"standing", added}, {"count", asks.size()}, {"version", with_.loop.world().newest()->version}};
  if (arguments.has("bands")) {
    const std::uint64_t parts = matching_parts(definition_of(arguments, {}), *with_.loop.world().newest());
    if (parts > 0) answer["parts"] = parts;
  }
  return answer;
}

void StandingCommands::add(const CommandAsk& ask, const Arguments& arguments) {
  FenceDefinition definition = definition_of(arguments, ask.blob);
  if (!arguments.truth("keep")) definition.owner = ask.client;
  if (ask.from.peer && !ask.from.peer->may_name(definition.name))
    throw BadCommand(fmt::format("the keys of '{}' are not for fence {}. Nothing was added", ask.from.peer->name,
                                 printable(definition.name)));
  const auto added = with_.loop.world().add_fence(definition);
  if (const auto* refusal = std::get_if<Refusal>(&added)) throw BadCommand(refusal->reason);
}

json StandingCommands::remove(const CommandAsk& ask, const Arguments& arguments) {
  std::vector<Named> chosen;
  json removed = json::array();
  for_each(arguments.text("name"), asked_form(arguments), [&](const Named& one) {
    chosen.push_back(one);
    removed.push_back(one.name);
  });
  for (const Named& one : chosen) refuse_if_foreign(ask, one.name, "removed");
  remove(chosen);
  return {{"standing", std::move(removed)}, {"version", with_.loop.world().newest()->version}};
}

void StandingCommands::remove(const std::vector<Named>& chosen) {
  for (const Named& one : chosen) {
    with_.inventory.erase({KeptKind::fence, one.name});
    with_.loop.world().remove_fence(one.name);
  }
  if (!chosen.empty()) step();
}

void StandingCommands::look_for_gone() {
  std::set<std::uint64_t> gone;
  for (const std::uint64_t client : owners_) {
    if (!answers_.answering().knows(client)) gone.insert(client);
  }
  if (gone.empty()) return;
  std::vector<Named> chosen;
  for_each("", {}, [&](const Named& one) {
    if (gone.contains(one.owner)) chosen.push_back(one);
  });
  remove(chosen);
  for (const std::uint64_t client : gone) {
    owners_.erase(client);
    answers_.answering().send_farewell(client);
  }
}

/// Calls visit() for the questions of this form whose names match the glob, those of bands last; a name without * ? [
/// is looked up.
void StandingCommands::for_each(const std::string& glob, std::optional<StandingForm> form, Visit visit) const {
  const Fences* fences = with_.loop.world().fences();
  if (fences == nullptr) return;
  const FenceTable& table = fences->table();
  const auto is_wanted = [&](StandingForm one) { return !form || *form == one; };
  const auto visit_slot = [&](std::uint32_t slot) {
    const StandingForm of = table.is_nearest(slot) ? StandingForm::nearest : StandingForm::region;
    if (is_wanted(of)) visit({.name = table.name(slot), .owner = table.rule(slot).owner, .slot = slot});
  };
  const auto visit_bands = [&](const FenceDefinition& bands) {
    visit({.name = bands.name, .owner = bands.owner, .bands = &bands});
  };
  if (!glob.empty() && glob.find_first_of("*?[") == std::string::npos) {
    if (const std::optional<std::uint32_t> slot = table.find(glob)) visit_slot(*slot);
    const auto bands = fences->margins().find(glob);
    if (bands != fences->margins().end() && is_wanted(StandingForm::bands)) visit_bands(bands->second);
    return;
  }
  const auto is_named_so = [&](const std::string& name) {
    return glob.empty() || wire_contract::glob_matches(glob, name);
  };
  for (std::uint32_t slot = 0; slot < table.size(); ++slot) {
    if (table.holds(slot) && !table.is_band(slot) && is_named_so(table.name(slot))) visit_slot(slot);
  }
  if (!is_wanted(StandingForm::bands)) return;
  for (const auto& [name, bands] : fences->margins()) {
    if (is_named_so(name)) visit_bands(bands);
  }
}

/// The objects that each region, band and question for the nearest holds, by its id.
StandingCommands::HeldById StandingCommands::held() const {
  HeldById held;
  const World& world = with_.loop.world();
  if (world.fences() == nullptr) return held;
  const FenceTable& table = world.fences()->table();
  for (const OpenContact& open : world.fences()->inside()) {
    const std::uint32_t slot = slot_of(open.b);
    const ObjectInfo* object = world.info(open.a);
    if (object == nullptr || !table.holds(slot) || table.id(slot) != open.b) continue;
    HeldObject one{.object = object->name,
                   .in_doubt = open.doubt != Doubt::none,
                   .since = std::chrono::nanoseconds(open.began_ns)};
    if (table.is_band(slot)) {
      const ObjectInfo* around = world.objects()[table.carrier(slot)].get();
      if (around == nullptr) continue;
      one.other = around->name;
      one.band_m = table.rule(slot).band->within_m;
    }
    held[open.b].push_back(std::move(one));
  }
  return held;
}

/// For each pair in bands the narrowest band that it is in, by the bands' name.
std::map<std::string, std::vector<HeldObject>> StandingCommands::narrowest(const HeldById& held) const {
  std::map<std::string, std::map<std::pair<std::string, std::string>, HeldObject>> pairs;
  for (const auto& [id, all] : held) {
    const FenceTable& table = with_.loop.world().fences()->table();
    if (!table.is_band(slot_of(id))) continue;
    for (const HeldObject& one : all) {
      const auto [known, is_new] =
          pairs[table.rule(slot_of(id)).band->margin].try_emplace({one.other, one.object}, one);
      if (!is_new && one.band_m < known->second.band_m) known->second = one;
    }
  }
  std::map<std::string, std::vector<HeldObject>> by_name;
  for (auto& [name, of_pairs] : pairs) {
    for (auto& [names, one] : of_pairs) by_name[name].push_back(std::move(one));
  }
  return by_name;
}

json StandingCommands::list(const Arguments& arguments) {
  if (arguments.truth("outlines")) return outlines(arguments);
  const std::uint64_t limit = arguments.whole("limit");
  const Fences* fences = with_.loop.world().fences();
  HeldById held = this->held();
  std::map<std::string, std::vector<HeldObject>> of_bands = narrowest(held);
  json rows = json::array();
  std::uint64_t count = 0;
  for_each(arguments.text("name"), asked_form(arguments), [&](const Named& one) {
    if (count++ >= limit) return;
    ListedStanding listed;
    if (one.bands != nullptr) {
      static_cast<DefinedStanding&>(listed) = defined_standing(*one.bands);
      listed.holds = std::move(of_bands[one.name]);
    } else {
      const FenceTable& table = fences->table();
      static_cast<DefinedStanding&>(listed) =
          defined_standing(one.name, table.rule(one.slot), table.described(one.slot));
      listed.holds = std::move(held[table.id(one.slot)]);
      listed.cut_short = table.is_nearest(one.slot) ? fences->cut_short(one.slot) : 0;
    }
    rows.push_back(json_of(listed));
  });
  return answer_of(std::move(rows), count);
}

json StandingCommands::outlines(const Arguments& arguments) {
  constexpr std::uint64_t kMostOutlines = 1'000;
  const std::uint64_t limit = std::min(arguments.whole("limit"), kMostOutlines);
  const World& world = with_.loop.world();
  HeldById held = this->held();
  json rows = json::array();
  std::uint64_t count = 0;
  const auto describe = [&](DefinedStanding defined, std::uint32_t slot) {
    if (count++ >= limit) return;
    const FenceTable& table = world.fences()->table();
    OutlinedStanding outlined{std::move(defined)};
    outlined.id = table.id(slot);
    if (table.is_band(slot)) {
      const bool is_there = table.is_carried(slot) && table.carrier(slot) != FenceTable::kNone;
      const ObjectInfo* about = is_there ? world.objects()[table.carrier(slot)].get() : nullptr;
      outlined.about = about != nullptr ? about->name : "";
      outlined.band_m = table.rule(slot).band->within_m;
    }
    outlined.holds = std::move(held[outlined.id]);
    if (arguments.truth("lines")) outlined.lines = lines_of(table, slot);
    rows.push_back(json_of(outlined));
  };
  std::map<std::string, DefinedStanding> of_bands;
  for_each(arguments.text("name"), asked_form(arguments), [&](const Named& one) {
    if (one.bands != nullptr) {
      of_bands.emplace(one.name, defined_standing(*one.bands));
    } else if (const FenceTable& table = world.fences()->table(); !table.is_nearest(one.slot)) {
      describe(defined_standing(one.name, table.rule(one.slot), table.described(one.slot)), one.slot);
    }
  });
  if (of_bands.empty()) return answer_of(std::move(rows), count);
  const FenceTable& table = world.fences()->table();
  for (std::uint32_t slot = 0; slot < table.size(); ++slot) {
    // Touching objects need no line.
    if (!table.holds(slot) || !table.is_band(slot) || table.rule(slot).band->within_m == 0) continue;
    const auto bands = of_bands.find(table.rule(slot).band->margin);
    if (bands != of_bands.end()) describe(bands->second, slot);
  }
  return answer_of(std::move(rows), count);
}

json StandingCommands::answer_of(json rows, std::uint64_t count) const {
  const World& world = with_.loop.world();
  const std::size_t bytes = world.fences() != nullptr ? world.fences()->table().bytes() : 0;
  return {{"standing", std::move(rows)}, {"count", count}, {"bytes", bytes}, {"version", world.newest()->version}};
}

}  // namespace collided::engine::service
