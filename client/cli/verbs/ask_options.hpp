#pragma once

#include <string>

#include <collided/client.hpp>

#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/session.hpp"

namespace CLI {
class App;
}

namespace collided::cli {

/// The options that every question has, as the user wrote them.
struct AskTexts {
  std::string only;
  std::string skip;
  std::string mask;
  std::string max_hits;
  std::string within;
  std::string deadline;
  std::string importance;
  std::string as_of;
  bool fresh = false;
};

/// The instant that a text means: latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds since 1970. Throws Failure.
Instant parse_instant(const std::string& text);

/// low, normal or high; empty: normal. Throws Failure.
Importance parse_importance(const std::string& text);

/// Declares those options on the parser.
void declare_ask_options(CLI::App& app, AskTexts& texts);
/// Declares how the file of a shape is read.
void declare_mesh_reading(CLI::App& app, MeshReading& reading);
/// The options for the library. Throws Failure.
AskOptions ask_options_of(const AskTexts& texts, const Globals& globals);

/// Prints a hint where a glob, given by the option named first, matches no object: a miss is then no real answer.
void hint_at_unknown_names(Session& session, const Globals& globals, std::string_view option, const std::string& glob);

}  // namespace collided::cli
