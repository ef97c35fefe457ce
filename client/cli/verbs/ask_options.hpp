#pragma once

#include <string>

#include <collided/client.hpp>

#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/session.hpp"

namespace CLI {
class App;
}

namespace collided::cli {

/// The instant named by a text: latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds since 1970. Throws Failure.
Instant parse_instant(const std::string& text);

/// Declares the options that every question has, except --timeout.
void declare_ask_options(CLI::App& app, AskOptions& options);
void declare_importance(CLI::App& app, Importance& importance);
/// Declares --as-of.
void declare_instant(CLI::App& app, Instant& instant, std::string meaning);
/// Declares how to read the file of a shape.
void declare_mesh_reading(CLI::App& app, MeshReading& reading);

/// Prints a hint if a glob, given by the option named first, matches no object: a miss is then not a real answer.
void hint_at_unknown_names(Session& session, const Globals& globals, std::string_view option, const std::string& glob);

}  // namespace collided::cli
