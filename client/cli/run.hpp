#pragma once

#include <string>
#include <vector>

#include "client/cli/command.hpp"

namespace collided::cli {

/// Runs the program `collide` with these arguments, without its own name. Returns its exit code. Never throws.
///
/// own  the parts of this program beyond the verbs that all have
int run(const std::vector<std::string>& arguments, Io& io, const OwnParts& own = {});

/// The same as a whole process: on its standard streams, with its signals handled.
int run_process(int argument_count, char** arguments, const OwnParts& own = {});

}  // namespace collided::cli
