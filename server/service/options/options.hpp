#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/service/commands/shard_place.hpp"

namespace collided::engine::service {

/// The server's configuration, each value checked. Keys, flags, variables and defaults: settings().
struct Options {
  std::string name_space;
  std::uint32_t threads = 0;          // that answer questions; 0: one a core
  std::uint32_t step_threads = 0;     // that decide within a step; 0: one a core, 8 at most
  std::int64_t step_ns = 0;           // 0: a step as soon as something has changed
  std::string state_dir;              // empty: chosen by epoch.hpp
  bool is_fresh = false;              // the state folder's content is dropped at the start
  std::optional<ShardPlace> shard{};  // of a shard, which serves in the namespace of the shard
  std::vector<std::string> scenes;    // files, loaded in this order; none: the embedded scene
  double unit_m = 1;                  // metres per unit of the scene files
  char up = 0;                        // axis of the scene files that points up, 'y' or 'z'; 0: as the format says
  std::optional<double> mend_m{};     // for the scene files, as in LoadOptions
  std::string solid;                  // glob of the names whose meshes are declared solid; empty: none
  bool solid_by_winding = false;      // those that are not closed are solid by their winding number
  std::vector<Aabb> covers;           // where the loaded scenes are complete, in the world; none: not stated
  std::uint32_t max_objects = 0;
  std::uint32_t max_contacts = 0;
  std::uint32_t max_intervals = 0;
  std::int64_t memory_ns = 0;       // how long poses are kept for questions about an instant; 0: not at all
  std::int64_t clock_error_ns = 0;  // by which publishers' clocks may differ
  std::int64_t forget_after_ns = 5'000'000'000;  // a lost publisher's objects stay stale for this long
  double error_m = 0;                            // for questions without one; 0: exact on doubt
  std::int64_t deadline_ns = 0;                  // for questions without one; 0: none
  std::int64_t flight_recorder_ns = 0;           // how far back; 0: none
  std::uint64_t audit_every = 0;                 // one answer in this many is recomputed; 0: none
  bool asks_fcl = false;                         // FCL gives its opinion on those answers too
  int domain = 0;                                // of DDS
  std::string interface;                         // "lo", "auto" or the name of a network interface
  std::vector<std::string> peers;                // additional hosts to look for
  std::string keys;                              // folder of keys; empty: none, and every client has all rights
  std::string log_level;
  bool log_json = false;

  bool check_config = false;  // these five: flags that do something other than serve
  bool print_config = false;
  bool once = false;
  bool show_version = false;
  bool show_help = false;
};

/// One setting: where it may be set, and what checks it.
struct Setting {
  const char* key;       // "table.name" in the file
  const char* flag;      // empty: none
  const char* variable;  // of the environment
  const char* fallback;  // the default, as it would be written
  const char* value;     // the value's name in the help; empty: the flag takes none
  const char* help;
  bool many;  // a list in the file, separated by commas elsewhere
  /// Checks the values and stores them; returns what is allowed if they are wrong. Without `many` there is one value.
  /// Null: ApplyFleetSetting does so.
  std::optional<std::string> (*apply)(Options&, std::span<const std::string> values);
};

/// Same as Setting::apply, for the settings of the fleet.
using ApplyFleetSetting =
    std::function<std::optional<std::string>(Options&, const Setting&, std::span<const std::string> values)>;

/// All settings, in the order of the help and of a printed configuration; those of one table follow one another.
std::span<const Setting> settings();

/// A setting's effective text and where it came from: "flag --threads", "env COLLIDED_DOMAIN", "x.toml:3", "default".
struct Effective {
  const Setting* setting = nullptr;
  std::vector<std::string> values;
  std::string origin;
};

/// The errors of the configuration: one or more lines for the user, without "error: ".
struct OptionsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// The options, and for each setting the text in effect and its origin. With show_help or show_version nothing else is
/// parsed.
struct ParsedOptions {
  Options options;
  std::vector<Effective> effective;  // in the order of settings()
};

/// Collects every setting. A flag takes precedence over a variable, that over the file, that over the default.
///
/// arguments  without the program's name
/// throws     OptionsError with where, what, what is allowed
ParsedOptions parse_options(const std::vector<std::string>& arguments, const Environment& environment,
                            const ApplyFleetSetting& fleet);

/// The effective configuration as a TOML file, with the origin of each value as a comment behind it.
std::string print_config(const ParsedOptions& parsed);

std::string help_text();

}  // namespace collided::engine::service
