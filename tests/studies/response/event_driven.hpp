#pragma once

#include <cstdint>
#include <vector>

#include "tests/studies/response/contact_solve.hpp"
#include "tests/studies/response/line.hpp"

namespace collided::response {

/// Rigid bodies on a line with restitution, from impact to impact: flights in closed form, each impact at its exact time
/// (but for rounding). What the stepping methods are measured against.
///
/// Rule of rest (Zeno): an impact slower than resting_speed, or one that leaves a body slower than it on a floor that
/// bears it, ends in rest. The bounces left out would have ended after 2 v / (g (1 - e)) and never risen above v^2 / 2g, v
/// the resting speed. Simultaneous impacts are answered pair by pair from the low end, again until none approaches.
/// Always: bodies keep their order; energy never grows but for rounding.
/// source   Brach, "Mechanical Impact Dynamics", 1991; Bernu, Mazighi, "One-dimensional bounce of inelastically colliding
///          marbles on a wall", J. Phys. A 23, 1990 (why a resting speed is needed without gravity, too)
class EventDriven {
 public:
  /// Throws std::invalid_argument where bodies overlap, or where restitution is below 1 and resting_speed 0: that might
  /// never end.
  EventDriven(Line line, Motion start, double restitution, double resting_speed_m_s = 0);

  void advance(double seconds);
  /// To the next impact, and through it; false if there is none.
  bool advance_to_impact();

  const Motion& motion() const { return motion_; }
  double time() const { return time_s_; }
  /// Pairs that bounced.
  std::uint64_t impacts() const { return impacts_; }
  /// Bodies that lie still on the floor or on each other.
  std::size_t resting_count() const { return resting_; }

 private:
  struct Next {
    double seconds;
    std::size_t contact;
    double approach_m_s;  // at the impact
  };
  Next next_impact() const;
  void move(double seconds);
  void answer(const Next& impact);
  void place(const Next& impact);
  double body_acceleration(std::size_t body) const { return body < resting_ ? 0 : line_.gravity_m_s2; }

  Line line_;
  Motion motion_;
  double restitution_;
  double resting_speed_m_s_;
  double time_s_ = 0;
  double time_lost_s_ = 0;  // what rounding has left out of the time so far: a million bounces add a million flights
  std::uint64_t impacts_ = 0;
  std::size_t resting_ = 0;  // the first so many bodies lie still
  std::vector<char> touching_;
  ContactSolve solve_;
};

}  // namespace collided::response
