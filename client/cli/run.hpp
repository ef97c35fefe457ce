#pragma once

#include <string>
#include <vector>

#include "client/cli/io.hpp"

namespace collided::cli {

/// Runs the program `collide` with these arguments, without its own name. Returns its exit code. Never throws.
int run(const std::vector<std::string>& arguments, Io& io);

}  // namespace collided::cli
