#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "idl/described_json.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

ProbeDefinition definition_of(const Arguments& arguments) {
  ProbeDefinition probe{.name = arguments.text("name"),
                        .object = arguments.text("object"),
                        .origin = arguments.vector("origin").value_or(Vec3::Zero()),
                        .direction = arguments.vector("direction").value_or(-Vec3::UnitZ()),
                        .reach_m = arguments.number("reach_m"),
                        .back_m = arguments.number("back_m")};
  for (const std::string* name : {&probe.name, &probe.object}) {
    if (!is_good_name(*name))
      throw BadCommand(fmt::format("probe: the name {} is empty, longer than 255 bytes or not text", printable(*name)));
  }
  return probe;
}

class ProbeCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;

 private:
  json probe(const CommandAsk& ask, const Arguments& arguments);
  json probes(const Arguments& arguments);
};

}  // namespace

std::unique_ptr<CommandFamily> probe_commands(CommandContext& context) {
  return std::make_unique<ProbeCommands>(context);
}

std::vector<BoundCommand> ProbeCommands::commands() {
  return {on_world_thread(names::kProbe, this, &ProbeCommands::probe),
          on_world_thread(names::kProbes, this, &ProbeCommands::probes)};
}

json ProbeCommands::probe(const CommandAsk& ask, const Arguments& arguments) {
  Probes& probes = with_.loop.probes();
  json changed = json::array();
  if (arguments.truth("remove")) {
    const std::vector<std::string> removed = probes.remove(arguments.text("name"));
    for (const std::string& name : removed) with_.inventory.erase({KeptKind::probe, name});
    changed = removed;
  } else {
    const ProbeDefinition definition = definition_of(arguments);
    if (const std::optional<Refusal> refusal = probes.set(definition)) throw BadCommand(refusal->reason);
    keep({KeptKind::probe, definition.name}, ask);
    changed.push_back(definition.name);
  }
  with_.loop.note_probes();
  return {{"probes", changed}, {"version", with_.loop.world().newest()->version}};
}

/// The reading of every probe in the newest state.
json ProbeCommands::probes(const Arguments& arguments) {
  const std::string glob = arguments.text("name");
  const std::vector<ProbeReading>& readings = with_.loop.read_probes();
  const auto object_name = [&](ObjectId id) {
    const ObjectInfo* info = id == 0 ? nullptr : with_.loop.world().info(id);
    return info ? info->name : std::string();
  };
  json rows = json::array();
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const ProbeDefinition& probe = with_.loop.probes().definition(i);
    if (!glob.empty() && !glob_matches(glob, probe.name)) continue;
    const ProbeReading& reading = readings[i];
    rows.push_back({{"probe", probe.name},
                    {"object", probe.object},
                    {"origin", json_of(probe.origin)},
                    {"direction", json_of(probe.direction)},
                    {"back_m", probe.back_m},
                    {"state", name_of(reading.state)},
                    {"clearance", reading.clearance_m},
                    {"error", reading.error_m},
                    {"met", object_name(reading.met)},
                    {"triangle", reading.triangle},
                    {"point", json_of(reading.point)},
                    {"normal", json_of(reading.normal)}});
    if (std::isfinite(probe.reach_m)) rows.back()["reach_m"] = probe.reach_m;
  }
  const SnapshotRing::Lease state = with_.loop.world().newest();
  return {{"probes", rows}, {"version", state->version}, {"world_time_ns", state->world_time_ns}};
}

}  // namespace collided::engine::service
