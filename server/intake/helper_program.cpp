#include "server/intake/helper_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

HelperProgram find_helper_program(const std::string& name, const char* variable) {
  if (const char* chosen = std::getenv(variable); chosen != nullptr && *chosen != '\0') {
    if (is_program(chosen)) return {.path = chosen, .why_not = {}};
    return {.path = {}, .why_not = fmt::format("{} is '{}', which is no program that can be run", variable, chosen)};
  }
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& place :
       {here / name, here / "../libexec/collided" / name, fs::path(COLLIDED_LIBEXEC_DIR) / name}) {
    if (is_program(place)) return {.path = place.string(), .why_not = {}};
  }
  return {.path = {},
          .why_not = fmt::format("{}, which is not in {} nor {}; {} may name it", name, here.string(),
                                 COLLIDED_LIBEXEC_DIR, variable)};
}

}  // namespace collided::engine
