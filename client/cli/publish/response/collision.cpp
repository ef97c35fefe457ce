#include "client/cli/publish/response/collision.hpp"

#include <algorithm>
#include <cmath>

#include "client/cli/publish/response/tolerance.hpp"

namespace collided::response {

void flip(Vec3& velocity_a, Vec3& velocity_b) {
  velocity_a = -velocity_a;
  velocity_b = -velocity_b;
}

double impact_impulse(double approach_m_s, InverseMasses masses, double restitution) {
  return approach_m_s > 0 ? (1 + restitution) * approach_m_s / masses.sum() : 0;
}

bool restitute(Vec3& velocity_a, Vec3& velocity_b, InverseMasses masses, const Vec3& normal, double restitution) {
  const double impulse = impact_impulse(normal.dot(velocity_a - velocity_b), masses, restitution);
  velocity_a -= impulse * masses.a * normal;
  velocity_b += impulse * masses.b * normal;
  return impulse > 0;
}

bool mirror_between_walls(double& position_m, double& velocity_m_s, double most_m, double restitution) {
  double& at = position_m;
  if (restitution == 1 && std::abs(at) > 4 * most_m) at = std::remainder(at, 4 * most_m);
  bool turned = false;
  for (int turn = 0; turn < kMostBounces && std::abs(at) > most_m; ++turn) {
    const double wall = at > 0 ? most_m : -most_m;
    at = restitution == 1 ? 2 * wall - at : wall - restitution * (at - wall);
    velocity_m_s *= -restitution;
    turned = true;
  }
  at = std::clamp(at, -most_m, most_m);
  return turned;
}

}  // namespace collided::response
