#include "client/cli/sibling_program.hpp"

#include <filesystem>

namespace collided::cli {

std::string sibling_program(const Io& io, const char* variable, const std::string& name) {
  namespace fs = std::filesystem;
  if (std::string chosen = io.env(variable); !chosen.empty()) return chosen;
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& place : {here / name, here / "../libexec/collided" / name, here / "../../server" / name}) {
    if (fs::is_regular_file(place, error)) return place.lexically_normal().string();
  }
  return name;
}

}  // namespace collided::cli
