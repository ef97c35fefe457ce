#pragma once

#include "client/cli/command.hpp"

namespace collided::cli {

/// The headings in the help for the options of every verb.
inline constexpr std::string_view kOutputGroup = "Output";
inline constexpr std::string_view kConnectionGroup = "Connection";

/// Declares the options that every verb has.
void declare_globals(CLI::App& app, Globals& globals);

/// Declares all options of `collide VERB`: its own, help, and those of every verb.
void declare_verb(CLI::App& app, Command& command, Globals& globals);

}  // namespace collided::cli
