#include "client/library/watching/pair_filter.hpp"

#include "idl/glob.hpp"

namespace collided::client {

using wire_contract::glob_matches;

bool is_wanted(const Event& event, const std::string& only, const std::string& skip) {
  const bool asked = only.empty() || glob_matches(only, event.a) || glob_matches(only, event.b);
  const bool skipped = !skip.empty() && (glob_matches(skip, event.a) || glob_matches(skip, event.b));
  return asked && !skipped;
}

}  // namespace collided::client
