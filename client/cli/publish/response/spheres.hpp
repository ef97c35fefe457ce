#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "client/cli/publish/response/collision.hpp"
#include "client/cli/publish/response/spring_contact.hpp"

namespace collided::response {

/// A sphere in metres and seconds, world coordinates.
struct Sphere {
  double radius_m = 0;
  Vec3 position;
  Vec3 velocity;
  Vec3 spin;  // rad/s about this axis
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// The mass in kg, for a density that gives a sphere of radius 1 m a mass of 1 kg.
double mass(const Sphere& sphere);

/// The response to a contact.
enum class ResponseLaw {
  flip,       // reverse both velocities, as in the homework's text
  impulse,    // Newton's restitution along the line of centres
  compliant,  // a spring and a damper
};

/// How spheres respond to contacts and walls.
struct SphereOptions {
  ResponseLaw answer = ResponseLaw::flip;
  bool every_frame =
      false;  // for flip: on every frame of a contact, as in the homework's text; else once for each contact
  double half_side_m = 0.5;    // half the side of the cube about the origin
  double restitution = 1;      // for impulse 0 to 1, for compliant kLeastDampedRestitution to 1
  double stiffness_n_m = 1e6;  // for compliant
};

/// Counts and sums for reports. Energies in J and momentum in N s, with mass() as the mass.
struct SphereLedger {
  std::uint64_t steps = 0;
  std::uint64_t contacts = 0;       // between two spheres, each episode counted once
  std::uint64_t flips = 0;          // responses to pairs: flips, impulses, or contacts of springs
  std::uint64_t sticking = 0;       // episodes with three responses or more
  std::uint64_t longest_flips = 0;  // responses in one episode at most
  std::array<std::uint64_t, 4>
      wall_hits{};  // by the number of velocity components reversed in one step: [1] faces, [2] edges, [3] corners
  std::uint64_t cube_contacts = 0;  // reported by the server
  double penetration_m =
      0;  // the largest, of reported pairs and of walls; for springs, by how much they were compressed
  double seen_overlap_m = 0;  // the largest overlap of reported pairs at the end of a step, which a viewer sees
  double energy_before = 0;
  double energy_after = 0;  // including that in springs
  Vec3 momentum_before = Vec3::Zero();
  Vec3 momentum_after = Vec3::Zero();

  /// The relative change of energy; 0 if nothing moved at the start.
  double energy_drift() const { return energy_before > 0 ? (energy_after - energy_before) / energy_before : 0; }
};

/// The facts of a reported contact; times in seconds before the spheres' newest positions. The default means that they
/// touch now.
struct Touch {
  double earliest_s = 0;  // it began between these two times
  double latest_s = 0;
  double seen_s = 0;  // when the spheres were where the depth was measured
  double depth_m = 0;
};

/// Moves spheres in a cube and computes their response to contacts. The server reports which spheres touch. Walls are
/// handled here: in closed form (with springs, at the exact time), so that no sphere leaves the cube however long a
/// step is.
///
/// A contact is reported when the two spheres already overlap. A spring nevertheless begins where and when they
/// touched: at the instant, within the reported times, that the depth and the velocities indicate. The two are moved
/// back to it, and then on from there with the contact: to deep in a soft spring, or past a stiff one. If either has
/// met something else since, the spring begins at that time, without load, so that the overlap adds no energy.
///
/// Each pair is solved for the whole step, one pair after the other (Lie's splitting). Each solution keeps its energy,
/// so the whole does too, however many contacts a sphere has. The price is the order of events within a step: if
/// another contact or a wall has moved one of the two, the spring keeps its load and its length is adapted.
///
/// threads    one at a time
/// invariant  with flip, speeds never change; except with springs, every centre is at least its radius inside the
///            walls.
class Spheres {
 public:
  Spheres() = default;
  /// Throws std::invalid_argument for a restitution that the response cannot have.
  Spheres(const SphereOptions& options, std::vector<Sphere> spheres);

  const std::vector<Sphere>& spheres() const { return spheres_; }
  /// The spheres with these indexes touch.
  void contact_began(std::size_t a, std::size_t b, const Touch& touch = {});
  /// They no longer touch. A spring that still pushes continues until it releases.
  void contact_ended(std::size_t a, std::size_t b);
  /// A sphere was found to touch the cube. `normal` is the face's, in either direction.
  void touched_cube(std::size_t sphere, const Vec3& normal);
  /// Responds to the contacts, then moves everything on by a time of 0 or more.
  void step(double seconds);
  SphereLedger ledger() const;

 private:
  /// A contact of a pair from its report to its end.
  struct Episode {
    std::uint64_t answers = 0;
    double touch_m = 0;      // distance of the centres when they touched
    double depth_m = 0;      // of the spring, while it pushes
    bool has_ended = false;  // contact_ended() was called
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
  std::map<Pair, Episode> open_;  // open contacts
  SphereLedger ledger_;
  Spring spring_;
  std::vector<double> free_s_;  // by sphere: for how long nothing has changed its velocity
};

}  // namespace collided::response
