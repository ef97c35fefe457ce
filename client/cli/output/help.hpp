#pragma once

#include "client/cli/command.hpp"

namespace collided::cli {

/// `collide` alone: what it is, two examples, the verbs by group, the guides.
void print_help(Io& io);

/// `collide help options`.
void print_common_options(Io& io);

/// `collide VERB -h`.
void print_verb_help(Io& io, const Verb& verb, const CLI::App& app);

}  // namespace collided::cli
