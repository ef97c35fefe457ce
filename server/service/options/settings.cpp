#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "idl/etcd_option.hpp"
#include "idl/topics.hpp"
#include "server/service/options/options.hpp"
#include "server/service/options/quantities.hpp"

namespace collided::engine::service {
namespace {

using Values = std::span<const std::string>;
using Allowed = std::optional<std::string>;

Allowed apply_namespace(Options& options, Values values) {
  if (!is_namespace(values[0])) return kNamespaces;
  options.name_space = values[0];
  return std::nullopt;
}

/// Stores a whole number from `low` to `high`; `note` is added to the text about allowed values.
template <class T>
Allowed apply_whole(T& field, Values values, std::int64_t low, std::int64_t high, const char* note = "") {
  const std::optional<std::int64_t> value = parse_whole(values[0]);
  if (!value || *value < low || *value > high) return fmt::format("a whole number from {} to {}{}", low, high, note);
  field = static_cast<T>(*value);
  return std::nullopt;
}

Allowed apply_threads(Options& options, Values values) {
  return apply_whole(options.threads, values, 0, 256, " (0: one a core)");
}

Allowed apply_step_threads(Options& options, Values values) {
  return apply_whole(options.step_threads, values, 0, 256, " (0: one a core, 8 at most)");
}

Allowed apply_step(Options& options, Values values) {
  if (values[0] == "on-sample") {
    options.step_ns = 0;
    return std::nullopt;
  }
  const std::optional<std::int64_t> period = parse_duration_ns(values[0]);
  if (!period || *period < 100'000 || *period > 10'000'000'000) return "'on-sample' or a time from 100us to 10s";
  options.step_ns = *period;
  return std::nullopt;
}

Allowed apply_state_dir(Options& options, Values values) {
  options.state_dir = values[0];
  return std::nullopt;
}

Allowed apply_scenes(Options& options, Values values) {
  for (const std::string& path : values) {
    if (path.empty()) return "paths of scene files";
  }
  options.scenes.assign(values.begin(), values.end());
  return std::nullopt;
}

Allowed apply_unit(Options& options, Values values) {
  const std::optional<double> unit = parse_unit_m(values[0]);
  if (!unit) return "um, mm, cm, dm, m, km, in, ft or a positive number of metres";
  options.unit_m = *unit;
  return std::nullopt;
}

Allowed apply_up(Options& options, Values values) {
  if (values[0] != "auto" && values[0] != "y" && values[0] != "z") return "'auto', 'y' or 'z'";
  options.up = values[0] == "auto" ? '\0' : values[0][0];
  return std::nullopt;
}

Allowed apply_mend(Options& options, Values values) {
  options.mend_m.reset();
  if (values[0] == "off") return std::nullopt;
  const std::optional<double> crack = values[0] == "auto" ? 0.0 : parse_length_m(values[0]);
  if (!crack || (*crack == 0 && values[0] != "auto")) {
    return "'off', 'auto' or the widest crack to close, such as 0.1mm";
  }
  options.mend_m = crack;
  return std::nullopt;
}

Allowed apply_solid_by(Options& options, Values values) {
  options.solid_by_winding = values[0] == "winding";
  if (options.solid_by_winding || values[0].empty()) return std::nullopt;
  return "'winding', or nothing";
}

Allowed apply_solid(Options& options, Values values) {
  options.solid = values[0];
  return std::nullopt;
}

Allowed apply_covers(Options& options, Values values) {
  options.covers.clear();
  if (options.shard && !values[0].empty()) return "nothing beside --shard: a shard covers what it holds";
  std::istringstream words(values[0]);
  for (std::string word; words >> word;) {
    const std::optional<std::array<double, 6>> box = parse_box_m(word);
    if (!box) return "boxes X0,Y0,Z0:X1,Y1,Z1 with the lower corner first, blanks between them; or nothing";
    options.covers.push_back({.low = {(*box)[0], (*box)[1], (*box)[2]}, .high = {(*box)[3], (*box)[4], (*box)[5]}});
  }
  return std::nullopt;
}

Allowed apply_max_objects(Options& options, Values values) {
  return apply_whole(options.max_objects, values, 1, 16'000'000);
}

Allowed apply_max_intervals(Options& options, Values values) {
  return apply_whole(options.max_intervals, values, 1, 1'000'000);
}
Allowed apply_max_contacts(Options& options, Values values) {
  return apply_whole(options.max_contacts, values, 1, 100'000'000);
}

Allowed apply_forget_after(Options& options, Values values) {
  const std::optional<std::int64_t> silence = parse_duration_ns(values[0]);
  if (!silence || *silence < 0 || *silence > 3'600'000'000'000) return "a time from 0 to 1h (3600s)";
  options.forget_after_ns = *silence;
  return std::nullopt;
}

Allowed apply_clock_error(Options& options, Values values) {
  const std::optional<std::int64_t> error = parse_duration_ns(values[0]);
  if (!error || *error < 0 || *error > 500'000'000) return "a time from 0 to 500ms";
  options.clock_error_ns = *error;
  return std::nullopt;
}

Allowed apply_memory(Options& options, Values values) {
  const std::optional<std::int64_t> reach = values[0] == "off" ? 0 : parse_duration_ns(values[0]);
  if (!reach || *reach < 0 || *reach > 3'600'000'000'000) return "'off' or a time up to 1h, such as 30s";
  options.memory_ns = *reach;
  return std::nullopt;
}

Allowed apply_deadline(Options& options, Values values) {
  if (values[0] == "none") {
    options.deadline_ns = 0;
    return std::nullopt;
  }
  const std::optional<std::int64_t> deadline = parse_duration_ns(values[0]);
  if (!deadline || *deadline <= 0) return "'none' or a time greater than 0, such as 5ms";
  options.deadline_ns = *deadline;
  return std::nullopt;
}

Allowed apply_error(Options& options, Values values) {
  const std::optional<double> error = parse_length_m(values[0]);
  if (!error) return "a length not below 0, such as 1um";
  options.error_m = *error;
  return std::nullopt;
}

Allowed apply_flight_recorder(Options& options, Values values) {
  if (values[0] == "off") {
    options.flight_recorder_ns = 0;
    return std::nullopt;
  }
  const std::optional<std::int64_t> window = parse_duration_ns(values[0]);
  if (!window || *window < 1'000'000'000 || *window > 600'000'000'000) return "'off' or a time from 1s to 10min (600s)";
  options.flight_recorder_ns = *window;
  return std::nullopt;
}

Allowed apply_audit(Options& options, Values values) {
  constexpr std::string_view kOneIn = "1/";
  if (values[0] == "off") {
    options.audit_every = 0;
    return std::nullopt;
  }
  const std::string& text = values[0];
  const bool fraction = text.starts_with(kOneIn);
  const std::optional<std::int64_t> every = parse_whole(std::string_view(text).substr(fraction ? kOneIn.size() : 0));
  if (!every || *every < 1 || (!fraction && *every != 1)) return "'off', '1' (all) or '1/N'";
  options.audit_every = static_cast<std::uint64_t>(*every);
  return std::nullopt;
}

Allowed apply_opinion(Options& options, Values values) {
  if (values[0] != "off" && values[0] != "fcl") return "'off' or 'fcl'";
  options.asks_fcl = values[0] == "fcl";
  return std::nullopt;
}

Allowed apply_domain(Options& options, Values values) {
  return apply_whole(options.domain, values, 0, wire_contract::kLastDomain);
}

Allowed apply_interface(Options& options, Values values) {
  if (!is_network_word(values[0])) return "'lo', 'auto' or the name of a network interface";
  options.interface = values[0];
  return std::nullopt;
}

Allowed apply_peers(Options& options, Values values) {
  for (const std::string& peer : values) {
    if (!is_network_word(peer)) return "host names or addresses";
  }
  options.peers.assign(values.begin(), values.end());
  return std::nullopt;
}

Allowed apply_keys(Options& options, Values values) {
  // The path becomes part of DDS's own configuration.
  if (values[0].find_first_of("<>&\"'$,") != std::string::npos) return "a folder whose path has none of < > & \" ' $ ,";
  options.keys = values[0];
  return std::nullopt;
}

Allowed apply_log_level(Options& options, Values values) {
  for (const char* level : {"trace", "debug", "info", "warn", "error", "off"}) {
    if (values[0] == level) {
      options.log_level = level;
      return std::nullopt;
    }
  }
  return "trace, debug, info, warn, error or off";
}

Allowed apply_truth(bool& field, Values values) {
  if (values[0] != "true" && values[0] != "false") return "true or false";
  field = values[0] == "true";
  return std::nullopt;
}

Allowed apply_fresh(Options& options, Values values) { return apply_truth(options.is_fresh, values); }

Allowed apply_log_json(Options& options, Values values) { return apply_truth(options.log_json, values); }

constexpr Setting kSettings[] = {
    {"server.namespace", "--namespace", "COLLIDED_NAMESPACE", "collided", "NAME",
     "topics are NAME/object_v2, NAME/query_v2, ...", false, apply_namespace},
    {"server.threads", "--threads", "COLLIDED_THREADS", "0", "N", "threads that answer; 0: one a core", false,
     apply_threads},
    {"server.step_threads", "--step-threads", "COLLIDED_STEP_THREADS", "0", "N",
     "threads that decide what touches; 0: one a core, 8 at most", false, apply_step_threads},
    {"server.step", "--step", "COLLIDED_STEP", "on-sample", "TIME", "period of the collision step, or on-sample", false,
     apply_step},
    {"server.state_dir", "--state-dir", "COLLIDED_STATE_DIR", "", "DIR",
     "keeps the epoch, the journal, uploads and flight records; default: the user's state folder", false,
     apply_state_dir},
    {"server.fresh", "--fresh", "COLLIDED_FRESH", "false", "",
     "start with an empty world: drop what commands before the last stop or crash brought in", false, apply_fresh},
    {"server.standby_of", "--standby-of", "COLLIDED_STANDBY_OF", "", "NAMESPACE",
     "stand by for the primary of that namespace: hold the same world, take its place where it fails", false, nullptr},
    {"server.join", "--join", "COLLIDED_JOIN", "", "NAMESPACE",
     "be a member of that namespace: stand by where a primary is there, else be the primary", false, nullptr},
    {"server.replica_of", "--replica-of", "COLLIDED_REPLICA_OF", "", "NAMESPACE",
     "be a replica of the primary of that namespace: hold the same world, answer questions beside it", false, nullptr},
    {"server.etcd_keys", etcd::kEtcdKeysFlag, etcd::kEtcdKeysVariable, "", "DIR", etcd::kEtcdKeysHelp, false, nullptr},
    {"server.shard", "--shard", "COLLIDED_SHARD", "", "MAP:NAME",
     "be the shard of that name in a shard map, a file or etcd://HOST:PORT/KEY: hold what comes into its box", false,
     nullptr},
    {"server.take_over_after", "--take-over-after", "COLLIDED_TAKE_OVER_AFTER", "200ms", "TIME",
     "of a standby: a primary that is silent for so long is replaced; or never", false, nullptr},
    {"server.authority", "--authority", "COLLIDED_AUTHORITY", "", "ADDRESS",
     "etcd://HOST:PORT,.../KEY: only who has its lease there is the primary; see the guide, failover", false, nullptr},
    {"server.authority_mode", "--authority-mode", "COLLIDED_AUTHORITY_MODE", "strict", "MODE",
     "a standby takes the place once the primary's lease has ended (strict), or at once (fast)", false, nullptr},
    {"server.authority_lease", "--authority-lease", "COLLIDED_AUTHORITY_LEASE", "3s", "TIME",
     "how long the lease lives; a primary that cannot confirm it for a third of that falls silent", false, nullptr},
    {"server.member", "--member", "COLLIDED_MEMBER", "", "NAME",
     "what collide fleet calls this server; default: the machine's name and the process number", false, nullptr},
    {"world.scenes", "", "COLLIDED_SCENES", "", "FILES", "scene files, loaded in order", true, apply_scenes},
    {"world.unit", "--unit", "COLLIDED_UNIT", "m", "UNIT", "of the scene files' numbers", false, apply_unit},
    {"world.up", "--up", "COLLIDED_UP", "auto", "AXIS", "of the scene files: y or z; auto: as the format says, else z",
     false, apply_up},
    {"world.mend", "--mend", "COLLIDED_MEND", "off", "WIDTH",
     "of the scene files: join points and cut edges up to so wide a crack, or auto", false, apply_mend},
    {"world.solid", "--solid", "COLLIDED_SOLID", "", "GLOB",
     "meshes of the scene files that are solid, by name, * for all; those that do not close stay surfaces", false,
     apply_solid},
    {"world.solid_by", "--solid-by", "COLLIDED_SOLID_BY", "", "winding",
     "those that do not close are solid by winding number: for inside and near --signed", false, apply_solid_by},
    {"world.covers", "--covers", "COLLIDED_COVERS", "", "BOXES",
     "where what is loaded is complete: X0,Y0,Z0:X1,Y1,Z1; outside of it nothing is called free", false, apply_covers},
    {"world.max_objects", "--max-objects", "COLLIDED_MAX_OBJECTS", "100000", "N", "static parts and moving objects",
     false, apply_max_objects},
    {"world.max_contacts", "--max-contacts", "COLLIDED_MAX_CONTACTS", "10000000", "N",
     "that one step may find; what comes after is truncated", false, apply_max_contacts},
    {"world.max_intervals", "--max-intervals", "COLLIDED_MAX_INTERVALS", "64", "N",
     "contacts of one pair between two poses; beyond them the pair is in doubt (cost_limit)", false,
     apply_max_intervals},
    {"world.clock_error", "--clock-error", "COLLIDED_CLOCK_ERROR", "0", "TIME",
     "of publishers' clocks against each other; widens brackets between objects of two", false, apply_clock_error},
    {"world.forget_after", "--forget-after", "COLLIDED_FORGET_AFTER", "5s", "TIME",
     "a lost publisher's objects stay stale for so long, before they leave by their lost policies", false,
     apply_forget_after},
    {"world.memory", "--memory", "COLLIDED_MEMORY", "30s", "TIME",
     "where objects were in so long is kept, for questions about an instant, at most 512 MiB of it; off", false,
     apply_memory},
    {"answer.error", "--error", "COLLIDED_ERROR", "0", "LENGTH", "good enough where none is asked; 0: exact on doubt",
     false, apply_error},
    {"answer.audit", "--audit", "COLLIDED_AUDIT", "off", "1/N",
     "one answer in N is worked out again, exactly and without index", false, apply_audit},
    {"answer.opinion", "--opinion", "COLLIDED_OPINION", "off", "NAME",
     "fcl: asked too about the answers that --audit works out again, in a process of its own", false, apply_opinion},
    {"answer.deadline", "--deadline", "COLLIDED_DEADLINE", "none", "TIME", "of questions that bring none", false,
     apply_deadline},
    {"recorder.last", "--flight-recorder", "COLLIDED_FLIGHT_RECORDER", "30s", "TIME",
     "what came and went in so long is kept in memory, at most 64 MiB of it; off", false, apply_flight_recorder},
    {"dds.domain", "--domain", "COLLIDED_DOMAIN", "0", "N", "DDS domain; else ROS_DOMAIN_ID", false, apply_domain},
    {"dds.interface", "--interface", "COLLIDED_INTERFACE", "lo", "NAME", "lo: this machine only; auto: the network",
     false, apply_interface},
    {"dds.peers", "--peers", "COLLIDED_PEERS", "", "HOSTS", "machines to look for besides", true, apply_peers},
    {"dds.keys", "--keys", "COLLIDED_KEYS", "", "DIR", "folder of keys (collide keys): only who has some may join",
     false, apply_keys},
    {"log.level", "--log", "COLLIDED_LOG", "info", "LEVEL", "trace, debug, info, warn, error, off", false,
     apply_log_level},
    {"log.json", "--log-json", "COLLIDED_LOG_JSON", "false", "", "log one JSON object a line", false, apply_log_json},
};

}  // namespace

std::span<const Setting> settings() { return kSettings; }

}  // namespace collided::engine::service
