#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"

namespace collided::engine::service {

/// What the server was told, each value checked. Keys, flags, variables and defaults: settings().
struct Options {
  std::string name_space;
  std::uint32_t threads = 0;        // that answer; 0: one a core
  std::int64_t step_ns = 0;         // 0: a step as soon as something has changed
  std::string state_dir;            // empty: chosen by epoch.hpp
  std::vector<std::string> scenes;  // files, loaded in order; none: the embedded scene
  double unit_m = 1;
  char up = 0;                     // 0: as the format says
  std::optional<double> mend_m{};  // of the scenes: as LoadOptions has it
  std::vector<Aabb> covers;        // of the world: where what is loaded is complete; none: not stated
  std::uint32_t max_objects = 0;
  std::uint32_t max_contacts = 0;
  std::int64_t memory_ns = 0;           // of poses, for questions about an instant; 0: none
  std::int64_t clock_error_ns = 0;      // of publishers' clocks against each other
  double error_m = 0;                   // of questions that ask for none; 0: exact on doubt
  std::int64_t deadline_ns = 0;         // of questions that bring none; 0: none
  std::int64_t flight_recorder_ns = 0;  // how far back; 0: none
  std::uint64_t audit_every = 0;        // one answer in so many is worked out again; 0: none
  bool asks_fcl = false;                // about those answers too
  int domain = 0;
  std::string interface;
  std::vector<std::string> peers;
  std::string log_level;
  bool log_json = false;

  bool check_config = false;
  bool print_config = false;
  bool once = false;
  bool show_version = false;
  bool show_help = false;
};

/// One setting: where it may be written and what checks it.
struct Setting {
  const char* key;       // "table.name" in the file
  const char* flag;      // empty: none
  const char* variable;  // in the environment
  const char* fallback;
  const char* value;  // what the help calls it
  const char* help;
  bool many;  // a list in the file, comma separated elsewhere
  /// Takes the values over; returns what is allowed where they are wrong.
  std::optional<std::string> (*apply)(Options&, std::span<const std::string> values);
};

std::span<const Setting> settings();

/// A setting's effective text and where it came from: "flag --threads", "env COLLIDED_DOMAIN", "x.toml:3", "default".
struct Effective {
  const Setting* setting = nullptr;
  std::vector<std::string> values;
  std::string origin;
};

/// One or more lines for the user, without "error: ".
struct OptionsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using Environment = std::function<const char*(const char*)>;

struct ParsedOptions {
  Options options;
  std::vector<Effective> effective;  // in the order of settings()
};

/// Flag before environment before file before default.
///
/// arguments  without the program's name
/// throws     OptionsError with where, what, what is allowed
ParsedOptions parse_options(const std::vector<std::string>& arguments, const Environment& environment);

/// The effective configuration as a TOML file, the origin of each value behind it.
std::string print_config(const ParsedOptions& parsed);

std::string help_text();

}  // namespace collided::engine::service
