#include "tests/studies/response/integrators.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace collided::response {
namespace {

constexpr int kMostNewtonRounds = 50;
using LongVec3 = Eigen::Matrix<long double, 3, 1>;

struct LongMotion {
  LongVec3 place;
  LongVec3 velocity;
};

LongVec3 pull(const SpringPair& pair, const LongVec3& place) {
  const long double distance = place.norm();
  return static_cast<long double>(pair.stiffness_n_m) / pair.reduced_mass_kg * (pair.length_m - distance) / distance *
         place;
}

LongMotion runge_kutta(const SpringPair& pair, const LongMotion& from, long double h) {
  const LongVec3 v1 = from.velocity, a1 = pull(pair, from.place);
  const LongVec3 v2 = from.velocity + h / 2 * a1, a2 = pull(pair, from.place + h / 2 * v1);
  const LongVec3 v3 = from.velocity + h / 2 * a2, a3 = pull(pair, from.place + h / 2 * v2);
  const LongVec3 v4 = from.velocity + h * a3, a4 = pull(pair, from.place + h * v3);
  return {from.place + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), from.velocity + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)};
}

}  // namespace

Vec3 SpringPair::acceleration(const Vec3& place_m) const {
  const double distance = place_m.norm();
  return stiffness_n_m / reduced_mass_kg * std::max(0.0, length_m - distance) / distance * place_m;
}

double SpringPair::energy(const RelativeMotion& motion) const {
  const double depth = std::max(0.0, length_m - motion.place_m.norm());
  return 0.5 * (reduced_mass_kg * motion.velocity_m_s.squaredNorm() + stiffness_n_m * depth * depth);
}

void explicit_euler(const SpringPair& pair, RelativeMotion& motion, double seconds) {
  const Vec3 before = motion.velocity_m_s;
  motion.velocity_m_s += seconds * pair.acceleration(motion.place_m);
  motion.place_m += seconds * before;
}

void velocity_verlet(const SpringPair& pair, RelativeMotion& motion, double seconds) {
  motion.velocity_m_s += 0.5 * seconds * pair.acceleration(motion.place_m);
  motion.place_m += seconds * motion.velocity_m_s;
  motion.velocity_m_s += 0.5 * seconds * pair.acceleration(motion.place_m);
}

void implicit_euler(const SpringPair& pair, RelativeMotion& motion, double seconds) {
  const Vec3 free = motion.place_m + seconds * motion.velocity_m_s;
  const double ratio = pair.stiffness_n_m / pair.reduced_mass_kg * seconds * seconds;
  // Where the spring pushes at the end, from the side that the spheres are on: the far side is a root, too, but not a motion.
  Vec3 place = free.norm() < pair.length_m
                   ? Vec3(motion.place_m.normalized() * std::min(pair.length_m, motion.place_m.norm()))
                   : free;
  for (int round = 0; round < kMostNewtonRounds && free.norm() < pair.length_m; ++round) {
    const double distance = place.norm();
    const Vec3 line = place / distance;
    const Vec3 missing = place - free - ratio * (pair.length_m - distance) * line;
    const Eigen::Matrix3d along = line * line.transpose();
    const Eigen::Matrix3d slope =
        Eigen::Matrix3d::Identity() +
        ratio * (along - (pair.length_m - distance) / distance * (Eigen::Matrix3d::Identity() - along));
    const Vec3 change = slope.partialPivLu().solve(missing);
    place -= change;
    if (change.norm() <= 1e-15 * pair.length_m) break;
  }
  motion.velocity_m_s = (place - motion.place_m) / seconds;
  motion.place_m = place;
}

void closed_form(const SpringPair& pair, RelativeMotion& motion, double seconds) {
  move_on_spring({.stiffness_n_m = pair.stiffness_n_m}, pair.reduced_mass_kg, pair.length_m, motion, seconds);
}

RelativeMotion true_motion(const SpringPair& pair, const RelativeMotion& start, double seconds) {
  LongMotion at{start.place_m.cast<long double>(), start.velocity_m_s.cast<long double>()};
  const long double closing = -at.place.dot(at.velocity), speed2 = at.velocity.squaredNorm();
  const long double length2 = static_cast<long double>(pair.length_m) * pair.length_m;
  const long double outside = std::max(0.0L, at.place.squaredNorm() - length2);
  const long double discriminant = closing * closing - speed2 * outside;
  const long double touch = closing > 0 && discriminant > 0 ? outside / (closing + std::sqrt(discriminant)) : INFINITY;
  long double left = seconds - std::min<long double>(touch, seconds);
  at.place += (seconds - left) * at.velocity;
  const long double step =
      std::acos(-1.0L) * std::sqrt(static_cast<long double>(pair.reduced_mass_kg) / pair.stiffness_n_m) / 20'000;
  bool holds = left > 0;
  while (left > 0 && holds) {
    long double h = std::min(step, left);
    LongMotion next = runge_kutta(pair, at, h);
    holds = next.place.norm() < pair.length_m;
    if (!holds) {
      long double low = 0;
      for (int round = 0; round < 70; ++round) {
        const long double middle = (low + h) / 2;
        (runge_kutta(pair, at, middle).place.norm() < pair.length_m ? low : h) = middle;
      }
      next = runge_kutta(pair, at, h);
    }
    at = next;
    left -= h;
  }
  at.place += left * at.velocity;
  return {at.place.cast<double>(), at.velocity.cast<double>()};
}

}  // namespace collided::response
