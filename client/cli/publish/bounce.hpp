#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <collided/client.hpp>

#include "client/response/spheres.hpp"

namespace collided::cli {

struct BounceOptions {
  std::size_t sphere_count = 20;
  double relative_size = 0.2;  // mean diameter over the cube's side; drawn from half to one and a half of it
  double side_m = 1;
  double speed_m_s = 0.5;  // largest velocity component
  double spin_rad_s = 0;   // largest angular speed
  std::uint64_t seed = 7;
  bool as_asked = false;  // flip on every frame of a contact, as the homework words it
  response::Answer answer = response::Answer::flip;
  double restitution = 1;      // of impulse and compliant
  double stiffness_n_m = 1e6;  // of compliant
};

using Sphere = response::Sphere;
using BounceLedger = response::SphereLedger;

/// Spheres of random sizes, places and velocities in a cube about the origin. The server says who touches whom, the response
/// library what becomes of it.
class Bounce {
 public:
  /// Throws Failure when the spheres cannot fit, or no spring loses as much as is asked.
  explicit Bounce(const BounceOptions& options);

  const std::vector<Sphere>& spheres() const { return response_.spheres(); }
  /// Spheres that had to be placed over another one.
  std::size_t overlapping_at_start() const { return overlapping_at_start_; }

  void contact_began(std::size_t a, std::size_t b, const response::Touch& touch = {}) {
    response_.contact_began(a, b, touch);
  }
  void contact_ended(std::size_t a, std::size_t b) { response_.contact_ended(a, b); }
  /// The server saw a sphere touch the cube; `normal` is the face's, either way.
  void touched_cube(std::size_t sphere, const Vec3& normal) { response_.touched_cube(sphere, normal); }
  /// Answers what is due, then moves everything on by a time of at least 0.
  void step(double seconds) { response_.step(seconds); }

  BounceLedger ledger() const { return response_.ledger(); }
  /// Radii in eight classes from the smallest to the largest allowed.
  std::array<std::size_t, 8> size_histogram() const;

 private:
  void place(std::vector<Sphere>& spheres, std::size_t sphere, std::uint64_t& random);

  BounceOptions options_;
  std::size_t overlapping_at_start_ = 0;
  response::Spheres response_;
};

}  // namespace collided::cli
