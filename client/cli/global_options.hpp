#pragma once

#include "client/cli/command.hpp"

namespace collided::cli {

/// Headings in the help under which those options stand.
inline constexpr std::string_view kOutputGroup = "Output";
inline constexpr std::string_view kConnectionGroup = "Connection";

/// The options that every verb knows.
void declare_globals(CLI::App& app, Globals& globals);

/// Everything that `collide VERB` takes: its own options, help, and the globals.
void declare_verb(CLI::App& app, Command& command, Globals& globals);

}  // namespace collided::cli
