#pragma once

#include "client/cli/command.hpp"

namespace collided::cli {

/// Prints the help of `collide` alone: a description, two examples, the verbs by group, the guides.
void print_help(Io& io);

/// Prints the help of `collide VERB -h`.
void print_verb_help(Io& io, const Verb& verb, const CLI::App& app);

}  // namespace collided::cli
