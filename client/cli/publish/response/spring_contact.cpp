#include "client/cli/publish/response/spring_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/cli/publish/response/tolerance.hpp"

namespace collided::response {
namespace {

/// The time in free flight until the distance has fallen to `length_m`; infinite if it never does.
double time_to_length(const RelativeMotion& motion, double length_m) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double closing = -motion.place_m.dot(motion.velocity_m_s);
  if (!(closing > 0)) return kNever;
  const double outside = std::max(0.0, motion.place_m.squaredNorm() - length_m * length_m);
  const double discriminant = closing * closing - motion.velocity_m_s.squaredNorm() * outside;
  return discriminant < 0 ? kNever : outside / (closing + std::sqrt(discriminant));
}

/// The largest depth within that time from the start of `phase`, whose own largest depth may come later.
double deepest_within(const ContactPhase& phase, double approach_m_s, double seconds) {
  const bool turns = approach_m_s > 0 && phase.depth_rate(seconds) <= 0;
  return turns ? phase.deepest() : std::max(phase.depth(0), phase.depth(seconds));
}

/// Moves the two through the contact, for at most `most_s`. Returns how long it lasted.
double hold(const Spring& spring, double mass_kg, double length_m, RelativeMotion& motion, double most_s,
            SpringRun& run) {
  const double distance = motion.place_m.norm();
  // Centres at one point have no line between them. The x axis is taken, so that all runs agree.
  const Vec3 line = distance > 0 ? Vec3(motion.place_m / distance) : Vec3::UnitX();
  const double rate = motion.velocity_m_s.dot(line);
  const Vec3 across = motion.velocity_m_s - rate * line;
  const double across_m_s = across.norm();
  // If the centres nearly meet, the line between them turns very fast; the turning is limited to that at this distance.
  const double least_m = kLeastDistance * length_m;
  const double spun = std::max(distance, least_m) * across_m_s;  // angular momentum over mass
  const double turning_s = kMostTurn * std::max(distance, least_m) / motion.velocity_m_s.norm();
  const double most = std::min(most_s, turning_s);
  const double depth = std::max(0.0, length_m - distance);
  const double approach = depth > 0 ? -rate : std::max(0.0, -rate);
  // A constant load that does the same work between the two distances as the true one, m spun^2 / r^3, so that treating
  // it as constant adds no energy.
  const auto centrifugal = [&](double from_m, double to_m) {
    return -mass_kg * spun * spun * (from_m + to_m) / (2 * from_m * from_m * to_m * to_m);
  };
  const double start = std::max(distance, least_m);
  ContactPhase phase(spring, mass_kg, approach, centrifugal(start, start), depth);
  double held = std::min(most, phase.duration());
  for (int round = 0; round < kLoadRounds; ++round) {
    phase = ContactPhase(spring, mass_kg, approach, centrifugal(start, std::max(least_m, length_m - phase.depth(held))),
                         depth);
    held = std::min(most, phase.duration());
  }
  const double end = length_m - phase.depth(held);
  const double turn = spun * held / (start * std::max(end, least_m));
  const Vec3 sideways = across_m_s > 0 ? Vec3(across / across_m_s) : Vec3(Vec3::Zero());
  const Vec3 turned_line = std::cos(turn) * line + std::sin(turn) * sideways;
  const Vec3 turned_sideways = std::cos(turn) * sideways - std::sin(turn) * line;
  motion.place_m = end * turned_line;
  motion.velocity_m_s = -phase.depth_rate(held) * turned_line;
  if (across_m_s > 0) motion.velocity_m_s += spun / std::max(end, least_m) * turned_sideways;
  run.deepest_m = std::max(run.deepest_m, deepest_within(phase, approach, held));
  run.depth_m = held < phase.duration() ? std::max(0.0, phase.depth(held)) : 0;
  return held;
}

bool pushes(const Spring& spring, double mass_kg, double depth_m, double approach_m_s) {
  if (depth_m > 0) return spring.stiffness_n_m * depth_m + spring.damping(mass_kg) * approach_m_s > 0;
  return depth_m == 0 && approach_m_s > 0;
}

}  // namespace

SpringRun move_on_spring(const Spring& spring, double reduced_mass_kg, double length_m, RelativeMotion& motion,
                         double seconds) {
  SpringRun run;
  double left = seconds;
  const double distance = motion.place_m.norm();
  const double approach =
      distance > 0 ? -motion.velocity_m_s.dot(motion.place_m) / distance : motion.velocity_m_s.norm();
  if (!pushes(spring, reduced_mass_kg, length_m - distance, approach)) {
    const double flight = std::min(left, time_to_length(motion, length_m));
    motion.place_m += flight * motion.velocity_m_s;
    left -= flight;
    run.began = left > 0;
  }
  run.began = run.began || (left > 0 && distance == length_m);
  bool holds = left > 0;
  while (left > 0 && holds) {
    run.pushed = true;
    left -= hold(spring, reduced_mass_kg, length_m, motion, left, run);
    holds = run.depth_m > 0;
  }
  // After the spring has released the two separate, so it does not touch again.
  if (left > 0) motion.place_m += left * motion.velocity_m_s;
  run.free_s = run.pushed ? std::max(left, 0.0) : seconds;
  return run;
}

SpringRun move_between_springs(const Spring& spring, double mass_kg, double most_m, double& position_m,
                               double& velocity_m_s, double seconds) {
  SpringRun run{.free_s = seconds};
  double left = seconds;
  bool is_let_go = false;  // the spring has released, so a force from rounding must not count as a new contact
  for (int round = 0; round < kMostBounces && left > 0; ++round) {
    double side = position_m < 0 ? -1 : 1;
    double depth = side * position_m - most_m;
    if (is_let_go || !pushes(spring, mass_kg, depth, side * velocity_m_s)) {
      if (velocity_m_s == 0) break;
      side = velocity_m_s < 0 ? -1 : 1;
      const double distance = std::max(0.0, most_m - side * position_m);
      const bool arrives = distance < std::abs(velocity_m_s) * left;
      position_m = arrives ? side * most_m : position_m + velocity_m_s * left;
      left = arrives ? left - distance / std::abs(velocity_m_s) : 0;
      if (!arrives) break;
      depth = 0;
    }
    run.began = run.began || depth == 0;
    run.pushed = true;
    const double approach = side * velocity_m_s;
    const ContactPhase phase(spring, mass_kg, approach, 0, depth);
    const double held = std::min(left, phase.duration());
    run.deepest_m = std::max(run.deepest_m, deepest_within(phase, approach, held));
    run.depth_m = held < phase.duration() ? std::max(0.0, phase.depth(held)) : 0;
    // Without damping it releases exactly at the wall, without a rounding to either side.
    const bool lets_go_at_wall = held == phase.duration() && spring.damping_ratio == 0;
    position_m = side * (most_m + (lets_go_at_wall ? 0 : phase.depth(held)));
    velocity_m_s = side * phase.depth_rate(held);
    is_let_go = true;
    left -= held;
    run.free_s = std::max(left, 0.0);
  }
  return run;
}

}  // namespace collided::response
