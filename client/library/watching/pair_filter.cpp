#include "client/library/watching/pair_filter.hpp"

#include <fnmatch.h>

namespace collided::client {
namespace {

bool matches(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
}

}  // namespace

bool is_wanted(const Event& event, const std::string& only, const std::string& skip) {
  const bool asked = only.empty() || matches(only, event.a) || matches(only, event.b);
  const bool skipped = !skip.empty() && (matches(skip, event.a) || matches(skip, event.b));
  return asked && !skipped;
}

}  // namespace collided::client
