#pragma once

#include <cstdint>
#include <vector>

#include "client/cli/publish/response/damper.hpp"
#include "tests/studies/response/line.hpp"

namespace collided::response {

/// A rigid ball dropped on a floor, in closed form. Its bounces follow in a geometric row and end: after that it lies still.
/// source   Zeno's row; any text on hybrid systems, e.g. Goebel, Sanfelice, Teel, "Hybrid Dynamical Systems", 2012, 1.1
struct RigidBall {
  double height_m = 1;  // of its lowest point at time 0, at rest
  double gravity_m_s2 = 9.81;
  double restitution = 0.5;

  double first_impact_s() const;
  /// Of impact n = 1, 2, ...
  double impact_s(std::uint64_t n) const;
  /// The end of all bounces: first * (1 + e) / (1 - e); infinite where e is 1.
  double rest_s() const;
  /// Impacts until a time; capped at the last that double can tell from rest.
  std::uint64_t impacts_until(double seconds) const;
  double height(double seconds) const;
};

struct ReferenceState {
  double position_m = 0;
  double velocity_m_s = 0;
  double deepest_m = 0;        // so far, of springs
  std::uint64_t contacts = 0;  // begun so far
};

/// The same ball, mass and gap of its lowest point, on a spring: flights and contacts in closed form, in turn.
/// error   of rounding without a damper. With one, a ball that its spring let go of below the surface flies on without a
///         force: right while speeds are far above gravity / frequency, so not for the last bounces before rest
/// cost    a few closed forms a contact
ReferenceState compliant_ball(const Spring& spring, double mass_kg, double gravity_m_s2, double height_m,
                              double velocity_m_s, double seconds);

/// Two bodies that meet on a spring, nothing else: centre of mass uniform, distance by the contact's closed form.
Motion compliant_pair(const Spring& spring, const Line& line, const Motion& start, double seconds);

}  // namespace collided::response
