#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace collided::response {

/// One method on one scene at one stiffness and one step, worst of several seeded starts.
struct ResponseRow {
  std::string scene = {};    // ball, resting, stack, pair, cradle
  std::string method = {};   // explicit_euler, semi_implicit_euler, implicit_euler, compliant, impulse, event_driven
  double stiffness_n_m = 0;  // infinity for the rigid methods
  double dt_s = 0;
  double stiffness_ratio = 0;  // k dt^2 / m; infinity for the rigid methods
  double energy_drift =
      0;  // change over T, springs counted, over the first energy; a resting scene: gain over its weight times 1 m
  double penetration_m = 0;        // deepest
  double penetration_bound_m = 0;  // deepest of the reference; at rest the static bound, load / k
  double error_m = 0;              // of positions at T against the reference with the same stiffness
  std::uint64_t missed = 0;        // contacts of the reference that the method never began
  std::uint64_t spurious = 0;      // contacts begun that the reference does not have
  double ns_per_step = 0;
  bool exploded = false;  // energy above ten times the first, or not finite; error and penetration say nothing then
};

struct StudyOptions {
  std::uint64_t seed = 1;
  int starts = 4;  // seeded starts a row
  double least_stiffness_n_m = 1e2;
  double largest_stiffness_n_m = 1e12;
  std::vector<double> steps_s = {1e-4, 1e-3, 1.0 / 60};
};

/// Every row, in a fixed order; same options, same rows but for ns_per_step.
/// cost       seconds
std::vector<ResponseRow> response_rows(const StudyOptions& options);

/// One line a row under one header line; numbers with all their digits.
void write_csv(std::ostream& out, const std::vector<ResponseRow>& rows);

}  // namespace collided::response
