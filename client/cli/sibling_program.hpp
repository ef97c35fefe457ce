#pragma once

#include <string>

#include "client/cli/io.hpp"

namespace collided::cli {

/// The path of a program that is installed with this one: the one that the environment's `variable` names; else beside
/// this program, with the installed helpers, or in a build tree; else its name, for PATH.
std::string sibling_program(const Io& io, const char* variable, const std::string& name);

}  // namespace collided::cli
