#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "client/response/collision.hpp"
#include "client/response/spring_contact.hpp"

namespace collided::response {

struct Sphere {
  double radius_m = 0;
  Vec3 position;
  Vec3 velocity;
  Vec3 spin;  // rad/s about this axis
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// kg, with the density that gives a sphere of radius 1 m a mass of 1 kg.
double mass(const Sphere& sphere);

enum class Answer {
  flip,       // both velocities of a pair turn round: the homework's
  impulse,    // Newton's restitution along the line of centres
  compliant,  // a spring and a damper
};

struct SphereOptions {
  Answer answer = Answer::flip;
  bool every_frame = false;    // of flip: on every frame of a contact, as the homework words it; else once
  double half_side_m = 0.5;    // of the cube about the origin
  double restitution = 1;      // of impulse 0 to 1, of compliant kLeastDampedRestitution to 1
  double stiffness_n_m = 1e6;  // of compliant
};

/// What happened; energies with mass() as the mass.
struct SphereLedger {
  std::uint64_t steps = 0;
  std::uint64_t contacts = 0;       // sphere against sphere, each episode once
  std::uint64_t flips = 0;          // answers to pairs: flips or impulses, or contacts on springs
  std::uint64_t sticking = 0;       // episodes answered three times or more
  std::uint64_t longest_flips = 0;  // of one episode
  std::array<std::uint64_t, 4>
      wall_hits{};                  // by number of components turned in one step: [1] faces, [2] edges, [3] corners
  std::uint64_t cube_contacts = 0;  // that the server reported
  double penetration_m = 0;  // deepest, of pairs that were reported and of walls; of springs: what they were pressed by
  double seen_overlap_m = 0;  // deepest of reported pairs in the places that a step ended with: what a viewer sees
  double energy_before = 0;
  double energy_after = 0;  // springs counted
  Vec3 momentum_before = Vec3::Zero();
  Vec3 momentum_after = Vec3::Zero();

  /// Relative; 0 where nothing moved at the start.
  double energy_drift() const { return energy_before > 0 ? (energy_after - energy_before) / energy_before : 0; }
};

/// What is known of a touch when it is told, in seconds before the spheres' newest places. Without: they touch as of now.
struct Touch {
  double earliest_s = 0;  // it happened between these
  double latest_s = 0;
  double seen_s = 0;  // when they were where the depth was found
  double depth_m = 0;
};

/// Spheres in a cube. Somebody else, the server, says who touches whom; this says what becomes of it. Walls are its own: they
/// are met in closed form (by springs: at the exact time), so that no sphere leaves however far a step goes.
///
/// A contact is told of when the two already overlap. A spring begins all the same where and when they touched: at the
/// instant within what is told that the depth and the velocities point to. The two are put back there, and what the contact
/// has made of them since is where and how fast they go on: deep in a soft spring, or past a stiff one. Where either has met
/// something else since, the spring begins then, unloaded, so that no overlap is energy from nowhere.
/// Each pair is solved for the whole step, one pair after the other (Lie's splitting): each solution keeps its energy, and so
/// does the whole, however many contacts a sphere has. What splitting costs is the order of events within a step: where
/// another contact or a wall has moved one of the two, the spring keeps its load, and its length is what that leaves.
/// Always: with flip, speeds never change; but for springs, every centre is at least its radius inside the walls.
class Spheres {
 public:
  Spheres() = default;
  /// Throws std::invalid_argument for a restitution that the answer cannot give.
  Spheres(const SphereOptions& options, std::vector<Sphere> spheres);

  const std::vector<Sphere>& spheres() const { return spheres_; }
  void contact_began(std::size_t a, std::size_t b, const Touch& touch = {});
  /// A spring that still pushes does so until it lets go.
  void contact_ended(std::size_t a, std::size_t b);
  /// A sphere was seen to touch the cube; `normal` is the face's, either way.
  void touched_cube(std::size_t sphere, const Vec3& normal);
  /// Answers what is due, then moves everything on by a time of at least 0.
  void step(double seconds);
  SphereLedger ledger() const;

 private:
  struct Episode {
    std::uint64_t answers = 0;
    double touch_m = 0;      // distance of the centres when they touched
    double depth_m = 0;      // of the spring, while it pushes
    bool has_ended = false;  // was told to have
  };
  using Pair = std::pair<std::size_t, std::size_t>;

  double gap(const Pair& pair) const;
  RelativeMotion between(const Pair& pair) const;
  bool answer(const Pair& pair, Episode& episode, double seconds);
  void catch_up(const Pair& pair, Episode& episode, const Touch& touch);
  bool push(const Pair& pair, Episode& episode, double length_m, double back_s, double seconds);
  void close(std::map<Pair, Episode>::iterator episode);
  void shift(Sphere& sphere, const Vec3& by) const;
  void move(std::size_t index, double seconds);
  double energy() const;
  Vec3 momentum() const;

  SphereOptions options_;
  std::vector<Sphere> spheres_;
  std::map<Pair, Episode> open_;  // contacts that hold
  SphereLedger ledger_;
  Spring spring_;
  std::vector<double> free_s_;  // of each sphere: since when nothing has changed its velocity
};

}  // namespace collided::response
