#pragma once

#include <string>
#include <vector>

#include "client/cli/io.hpp"

namespace collided::cli {

/// The program `collide` from its arguments (without its own name) to its exit code. Never throws.
int run(const std::vector<std::string>& arguments, Io& io);

}  // namespace collided::cli
