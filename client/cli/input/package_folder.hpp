#pragma once

#include <string>

namespace collided::cli {

/// "NAME=DIR" with DIR as an absolute path, for a server that runs in another folder. Throws Failure if there is no
/// name or no folder.
std::string absolute_package(const std::string& text);

}  // namespace collided::cli
