#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <collided/client.hpp>

namespace collided::cli {

struct BounceOptions {
  std::size_t sphere_count = 20;
  double relative_size = 0.2;  // mean diameter over the cube's side; drawn from half to one and a half of it
  double side_m = 1;
  double speed_m_s = 0.5;      // largest velocity component
  double spin_rad_s = 0;       // largest angular speed
  std::uint64_t seed = 7;
  bool as_asked = false;       // flip on every frame of a contact, as the homework words it
};

struct Sphere {
  double radius_m = 0;
  Vec3 position;
  Vec3 velocity;
  Vec3 spin;  // rad/s about this axis
  Quat rotation = Quat::Identity();
};

/// What happened; energies in units of a mass of 1 for a sphere of radius 1.
struct BounceLedger {
  std::uint64_t steps = 0;
  std::uint64_t contacts = 0;              // sphere against sphere, each episode once
  std::uint64_t flips = 0;                 // of pairs
  std::uint64_t sticking = 0;              // episodes in which a pair flipped on three frames or more
  std::uint64_t longest_flips = 0;         // of one episode
  std::array<std::uint64_t, 4> wall_hits{};  // by number of components flipped in one step: [1] faces, [2] edges, [3] corners
  std::uint64_t cube_contacts = 0;         // that the server reported
  double energy_before = 0;
  double energy_after = 0;
  Vec3 momentum_before = Vec3::Zero();
  Vec3 momentum_after = Vec3::Zero();
};

/// Spheres in a cube about the origin. The server says who touches whom; this says what becomes of it: both velocities of a
/// pair are flipped in all components, at a wall only the component along its normal. Walls are reflected in closed form, so
/// that no sphere leaves however far a step goes.
/// Always: every centre is at least its radius inside the walls, and speeds never change.
class Bounce {
 public:
  /// Throws Failure when the spheres cannot fit.
  explicit Bounce(const BounceOptions& options);

  const std::vector<Sphere>& spheres() const { return spheres_; }
  /// Spheres that had to be placed over another one.
  std::size_t overlapping_at_start() const { return overlapping_at_start_; }

  void contact_began(std::size_t a, std::size_t b);
  void contact_ended(std::size_t a, std::size_t b);
  /// The server saw a sphere touch the cube; `normal` is the face's, either way.
  void touched_cube(std::size_t sphere, const Vec3& normal);

  /// Flips what is due, then moves everything on by a time of at least 0.
  void step(double seconds);

  BounceLedger ledger() const;
  /// Radii in eight classes from the smallest to the largest allowed.
  std::array<std::size_t, 8> size_histogram() const;

 private:
  using Pair = std::pair<std::size_t, std::size_t>;
  void place(std::size_t sphere, std::uint64_t& random);
  void flip_contacts();
  void reflect(Sphere& sphere);
  void end_episode(std::uint64_t flips);

  BounceOptions options_;
  std::vector<Sphere> spheres_;
  std::map<Pair, std::uint64_t> open_;  // contacts that hold, and how often their pair flipped
  std::size_t overlapping_at_start_ = 0;
  BounceLedger ledger_;
};

}  // namespace collided::cli
