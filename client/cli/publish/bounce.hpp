#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/publish/response/spheres.hpp"

namespace collided::cli {

/// The spheres, and how they answer contacts.
struct BounceOptions {
  std::size_t sphere_count = 20;
  // Mean diameter as a fraction of the cube's side. Diameters are random, from half to one and a half of the mean.
  double relative_size = 0.2;
  double side_m = 1;
  double speed_m_s = 0.5;  // largest velocity component
  double spin_rad_s = 0;   // largest angular speed
  std::uint64_t seed = 7;
  bool as_asked = false;  // flip on every frame of a contact, as in the homework's text
  response::ResponseLaw answer = response::ResponseLaw::flip;
  double restitution = 1;      // for impulse and compliant
  double stiffness_n_m = 1e6;  // for compliant
};

using Sphere = response::Sphere;
using BounceLedger = response::SphereLedger;

/// Spheres of random sizes, places and velocities in a cube about the origin. The server finds which of them touch; the
/// response library computes the consequences. One thread.
class Bounce {
 public:
  /// Throws Failure if the spheres cannot fit, or if no spring loses as much as the restitution requires.
  explicit Bounce(const BounceOptions& options);

  const std::vector<Sphere>& spheres() const { return response_.spheres(); }
  /// How many spheres had to be placed overlapping another one.
  std::size_t overlapping_at_start() const { return overlapping_at_start_; }

  void contact_began(std::size_t a, std::size_t b, const response::Touch& touch = {}) {
    response_.contact_began(a, b, touch);
  }
  void contact_ended(std::size_t a, std::size_t b) { response_.contact_ended(a, b); }
  /// The server found that a sphere touches the cube. `normal` is the face's, in either direction.
  void touched_cube(std::size_t sphere, const Vec3& normal) { response_.touched_cube(sphere, normal); }
  /// Responds to the contacts, then moves everything on by a time of 0 or more.
  void step(double seconds) { response_.step(seconds); }

  BounceLedger ledger() const { return response_.ledger(); }
  /// How many radii are in each of eight equal classes from the smallest to the largest possible.
  std::array<std::size_t, 8> size_histogram() const;

 private:
  void place(std::vector<Sphere>& spheres, std::size_t sphere, std::uint64_t& random);

  BounceOptions options_;
  std::size_t overlapping_at_start_ = 0;
  response::Spheres response_;
};

}  // namespace collided::cli
