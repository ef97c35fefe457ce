#include "server/geometry/pose.hpp"

namespace collided {

Vec3 place(const Frame& frame, const Vec3& point) {
  const Mat3& r = frame.rotation;
  Vec3 placed;
  for (int row = 0; row < 3; ++row) {
    placed[row] = ((r(row, 0) * point[0] + r(row, 1) * point[1]) + r(row, 2) * point[2]) + frame.position[row];
  }
  return placed;
}

}  // namespace collided
