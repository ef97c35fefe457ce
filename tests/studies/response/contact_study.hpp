#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace collided::response {

/// One way to step the oblique contact of two spheres, at one stiffness and one step: the worst of several seeded starts.
struct ContactRow {
  std::string integrator =
      {};  // explicit_euler, velocity_verlet, implicit_euler, closed_form; spheres: as they are published
  double stiffness_n_m = 0;
  double dt_s = 0;
  double error = 0;  // of place over the spring's length, or of velocity over its own, at the end; the larger
  double energy_drift =
      0;  // largest change at any step, kinetic and k d^2 / 2 of the real overlap, over the first energy
  double penetration_m = 0;  // deepest; of the methods that step, at a step's end
  double law_m = 0;          // v sqrt(m / k), v along the line of centres at the touch
  double ns = 0;             // for the frame, median of the starts
};

struct ContactStudyOptions {
  std::uint64_t seed = 1;
  int starts = 5;
  int most_halvings = 20;  // of a frame of 1/60 s, two at a time, at 1e2, 1e7 and 1e12 N/m; at the others half as many
};

/// One frame of 1/60 s in which two spheres come together; what the frame should end with is found in long double by a method of
/// fourth order with twenty thousand steps a contact. Stiffness in decades from 1e2 to 1e12 N/m.
/// cost   seconds
std::vector<ContactRow> contact_rows(const ContactStudyOptions& options);

/// One line a row under one header line.
void write_csv(std::ostream& out, const std::vector<ContactRow>& rows);

}  // namespace collided::response
