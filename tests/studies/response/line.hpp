#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace collided::response {

/// Bodies in a row on a line between two walls: what a contact does happens along its normal, so balls on a floor, stacks,
/// cradles and billiards in a row are all of this kind.
/// Contact c, of size() + 1, is between body c - 1 and body c; body -1 is the low wall, body size() the high one.
struct Line {
  std::vector<double> mass_kg;
  std::vector<double> radius_m;  // half of a body's length
  double gravity_m_s2 = 0;       // along the line; negative where the low wall is the floor
  double low_wall_m = -std::numeric_limits<double>::infinity();
  double high_wall_m = std::numeric_limits<double>::infinity();

  std::size_t size() const { return mass_kg.size(); }
  double inverse_mass_below(std::size_t contact) const { return contact == 0 ? 0 : 1 / mass_kg[contact - 1]; }
  double inverse_mass_above(std::size_t contact) const { return contact == size() ? 0 : 1 / mass_kg[contact]; }
  /// Of the two sides of a contact, kg; against a wall the body's own.
  double reduced_mass(std::size_t contact) const {
    return 1 / (inverse_mass_below(contact) + inverse_mass_above(contact));
  }
};

/// Where the bodies of a line are and how fast.
struct Motion {
  std::vector<double> position_m;
  std::vector<double> velocity_m_s;
};

/// Negative where two bodies are inside each other; infinite where there is no wall.
double gap(const Line& line, const std::vector<double>& position_m, std::size_t contact);
/// How fast a gap grows.
double gap_rate(const Line& line, const std::vector<double>& velocity_m_s, std::size_t contact);
/// How fast that grows where nothing touches: gravity acts on bodies, not on walls.
double free_gap_acceleration(const Line& line, std::size_t contact);
/// Of positions and radii, m: what rounding errors of gaps are measured by.
double largest_coordinate(const Line& line, const Motion& motion);
/// At most which a gap is called touching: kTouching of the largest coordinate.
double touching_gap(const Line& line, const Motion& motion);

double kinetic_energy(const Line& line, const Motion& motion);
/// Zero where a body's centre is at 0.
double gravity_energy(const Line& line, const Motion& motion);
double momentum(const Line& line, const Motion& motion);
/// Of the deepest contact; 0 where none overlaps.
double deepest_penetration(const Line& line, const Motion& motion);

/// Moves every body as if nothing touched: exact but for rounding.
void fly(const Line& line, Motion& motion, double seconds);

/// When a gap closes in free flight: the first time at least 0 at which it is 0 and does not grow; infinite if never.
/// A gap of 0 that grows is not closing: the root behind it is what counts, so a bounce never meets its own start again.
/// source   the stable form of the quadratic's roots: Higham, "Accuracy and Stability of Numerical Algorithms", 2002, 1.8
double time_to_touch(double gap_m, double rate_m_s, double acceleration_m_s2);

}  // namespace collided::response
