#include "client/cli/input/package_folder.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

std::string absolute_package(const std::string& text) {
  const std::size_t sign = text.find('=');
  if (sign == 0 || sign == std::string::npos || sign + 1 == text.size())
    throw bad_use(fmt::format("--package '{}'; it is to be NAME=DIR", printable(text)));
  return text.substr(0, sign + 1) + std::filesystem::absolute(text.substr(sign + 1)).lexically_normal().string();
}

}  // namespace collided::cli
