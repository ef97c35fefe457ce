#include "server/exact_phase/given/given_part.hpp"

#include "server/geometry/placing_error.hpp"

namespace collided::engine {

double GivenPart::placing_error_m(double far_m) const {
  if (std::holds_alternative<std::monostate>(own)) return 0;
  if (frame == nullptr) {
    const Frame worked_out = frame_of(*pose);
    return GivenPart{.own = own, .pose = pose, .frame = &worked_out}.placing_error_m(far_m);
  }
  if (const auto* triangle = std::get_if<Triangle>(&own)) return engine::placing_error_m(*frame, *triangle);
  return engine::placing_error_m(*frame, *std::get<const Primitive*>(own), far_m);
}

}  // namespace collided::engine
