#include "server/exact_phase/motion/common_origin.hpp"

#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// So many times farther from the world's origin than the two bodies are from each other on their ways. Nearer than that a
/// coordinate is rounded by less than a billionth of their distance, and brackets are as narrow without a common origin.
constexpr double kFarOut = 0x1p20;

/// x - y is not rounded: the error of the difference (Knuth, The Art of Computer Programming 2, 4.2.2, theorem B) is zero.
bool is_difference_exact(double x, double y) {
  const double difference = x - y;
  const double y_virtual = x - difference;
  const double x_virtual = difference + y_virtual;
  return (x - x_virtual) + (y_virtual - y) == 0;
}

bool is_difference_exact(const Vec3& x, const Vec3& y) {
  return is_difference_exact(x[0], y[0]) && is_difference_exact(x[1], y[1]) && is_difference_exact(x[2], y[2]);
}

double away_m(const BodyMotion& motion, const Vec3& origin) {
  return (motion.from.position - origin).lpNorm<1>() + (motion.to.position - origin).lpNorm<1>();
}

}  // namespace

CommonOrigin::CommonOrigin(const BodyMotion& a, const BodyMotion& b) : origin_(b.from.position) {
  if (!(origin_.lpNorm<1>() > kFarOut * (away_m(a, origin_) + away_m(b, origin_)))) return;
  is_taken_ = see(a, a_, given_a_) && see(b, b_, given_b_);
}

/// False: some position cannot be seen from the origin without rounding.
bool CommonOrigin::see(const BodyMotion& motion, BodyMotion& seen, Pose& given) const {
  if (!is_difference_exact(motion.from.position, origin_) || !is_difference_exact(motion.to.position, origin_))
    return false;
  const auto moved = [&](const Frame& frame) {
    return Frame{.rotation = frame.rotation, .position = frame.position - origin_};
  };
  seen = BodyMotion(moved(motion.from), moved(motion.to), motion.pivot);
  if (motion.given == nullptr) return true;
  given = *motion.given;
  if (given.position != motion.from.position) return false;
  given.position -= origin_;
  seen.given = &given;
  return true;
}

}  // namespace collided::engine
