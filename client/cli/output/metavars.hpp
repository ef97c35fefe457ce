#pragma once

#include <string_view>

namespace collided::cli {

/// What the help of a verb writes after an option to stand for its value, such as "X Y Z" or "GLOB"; empty for an unknown
/// option.
std::string_view metavar_of(std::string_view verb, std::string_view option);

}  // namespace collided::cli
