#include "server/world/fences/nearest.hpp"

#include <fmt/format.h>

#include <cmath>

namespace collided::engine {

std::string refusal_of(const NearestRule& rule) {
  if (!(rule.within_m > 0) || !std::isfinite(rule.within_m))
    return fmt::format("it looks {} m far; a finite distance above 0 is needed", rule.within_m);
  if (!(rule.hysteresis_m >= 0) || !std::isfinite(rule.reach_m()))
    return fmt::format("its hysteresis is {} m; a finite distance, 0 or more, is needed", rule.hysteresis_m);
  return {};
}

}  // namespace collided::engine
