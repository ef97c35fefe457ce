#include "tests/studies/report/measured/time_truth.hpp"

#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;

using oracle::Wide;

Truth first_time(const std::function<Wide(const Wide&)>& above) {
  if (above(0) <= 0) return {true, 0};
  Wide low = 0;
  Wide high = 1;
  for (int i = 0; i < 260; ++i) {
    const Wide left = low + (high - low) * Wide(0.4);
    const Wide right = low + (high - low) * Wide(0.6);
    const Wide at_left = above(left);
    if (at_left <= 0) {
      high = left;
      break;
    }
    (at_left < above(right) ? high : low) = at_left < above(right) ? right : left;
  }
  // The lowest place is known to 1e-57; coordinates that are doubles of ordinary size miss by more than this, or touch.
  const Wide touching(1e-50);
  if (above(high) > touching) return {};
  low = 0;
  for (int i = 0; i < 200; ++i) {
    const Wide middle = (low + high) / 2;
    (above(middle) <= touching ? high : low) = middle;
  }
  return {true, high};
}

Truth time_truth(const MovingSphere& mover, const Triangle& triangle) {
  const V<Wide> start(mover.start);
  const V<Wide> step = V<Wide>(mover.end) - start;
  const Wide radius(mover.radius_m);
  return first_time([&](const Wide& t) { return Wide(plain_distance(start + step * t, triangle) - radius); });
}

}  // namespace collided::report
