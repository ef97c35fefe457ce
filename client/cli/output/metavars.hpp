#pragma once

#include <string_view>

namespace collided::cli {

/// What the help writes after an option that takes a value, "X Y Z" or "GLOB"; empty for an option that is not known.
std::string_view metavar_of(std::string_view option);

}  // namespace collided::cli
