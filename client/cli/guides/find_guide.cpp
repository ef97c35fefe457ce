#include "client/cli/guides/guides.hpp"

namespace collided::cli {

const Guide* find_guide(std::string_view name) {
  for (const Guide& guide : guides()) {
    if (guide.name == name) return &guide;
  }
  return nullptr;
}

}  // namespace collided::cli
