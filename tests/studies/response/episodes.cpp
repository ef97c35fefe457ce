#include "tests/studies/response/episodes.hpp"

namespace collided::response {

void Episodes::restart() {
  open_.clear();
  began_ = ended_ = 0;
}

void Episodes::observe(const Line& line, const Motion& motion) {
  open_.resize(line.size() + 1, 0);
  const double apart_m = hysteresis_ * largest_coordinate(line, motion);
  for (std::size_t contact = 0; contact <= line.size(); ++contact) {
    const double open_m = gap(line, motion.position_m, contact);
    if (!open_[contact] && open_m <= apart_m / 2) {
      open_[contact] = 1;
      ++began_;
    } else if (open_[contact] && open_m > apart_m) {
      open_[contact] = 0;
      ++ended_;
    }
  }
}

}  // namespace collided::response
