#include "server/geometry/orientation.hpp"

#include "server/geometry/expansion.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

OrientedPlane::OrientedPlane(const Vec3& a, const Vec3& b, const Vec3& c)
    : a_(a),
      b_(b),
      c_(c),
      normal_((b - a).cross(c - a)),
      spread_(kOrientationError * (b - a).cwiseAbs().maxCoeff() * (c - a).cwiseAbs().maxCoeff()) {}

std::optional<int> OrientedPlane::exact_side(const Vec3& d) const {
  const auto along = [this](const Vec3& to, int axis) { return Expansion(to[axis]) - Expansion(a_[axis]); };
  const auto minor = [&](int i, int j) { return along(b_, i) * along(c_, j) - along(b_, j) * along(c_, i); };
  const Expansion volume = (minor(1, 2) * along(d, 0) + minor(2, 0) * along(d, 1)) + minor(0, 1) * along(d, 2);
  if (volume.lost()) return std::nullopt;
  const double leading = volume.leading();
  return leading > 0 ? 1 : leading < 0 ? -1 : 0;
}

std::optional<int> orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return OrientedPlane(a, b, c).side(d);
}

}  // namespace collided::engine
