#include "client/cli/input/solid_flag.hpp"

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

bool SolidFlag::is_by_winding() const {
  if (word.empty() || word == "true") return false;
  if (word != "winding") throw bad_use(fmt::format("--solid={}; allowed: winding, or nothing", printable(word)));
  return true;
}

}  // namespace collided::cli
