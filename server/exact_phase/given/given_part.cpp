#include "server/exact_phase/given/given_part.hpp"

#include "server/geometry/placing_error.hpp"

namespace collided::engine {

double GivenPart::placing_error_m(double far_m) const {
  if (const auto* triangle = std::get_if<Triangle>(&own)) return engine::placing_error_m(*frame, *triangle);
  if (const auto* const* primitive = std::get_if<const Primitive*>(&own))
    return engine::placing_error_m(*frame, **primitive, far_m);
  return 0;
}

}  // namespace collided::engine
