#include "client/cli/publish/bounce.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/number.hpp"

namespace collided::cli {
namespace {

/// source  Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014 (SplitMix64)
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

/// Uniform in [low, high): the same numbers on every machine, unlike std's distributions.
double uniform(std::uint64_t& state, double low, double high) {
  const double unit = static_cast<double>(next_random(state) >> 11) * 0x1p-53;
  return low + (high - low) * unit;
}

Vec3 uniform_vector(std::uint64_t& state, double most) {
  const double x = uniform(state, -most, most);
  const double y = uniform(state, -most, most);
  const double z = uniform(state, -most, most);
  return {x, y, z};
}

double mass(const Sphere& sphere) {
  return sphere.radius_m * sphere.radius_m * sphere.radius_m;
}

double energy(const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& sphere : spheres) sum += 0.5 * mass(sphere) * sphere.velocity.squaredNorm();
  return sum;
}

Vec3 momentum(const std::vector<Sphere>& spheres) {
  Vec3 sum = Vec3::Zero();
  for (const Sphere& sphere : spheres) sum += mass(sphere) * sphere.velocity;
  return sum;
}

constexpr std::uint64_t kStickingFlips = 3;
constexpr int kMostPlacements = 1'000;

}  // namespace

Bounce::Bounce(const BounceOptions& options) : options_(options) {
  const double largest_radius = options.relative_size * options.side_m * 0.75;
  if (!(largest_radius * 2 < options.side_m)) {
    throw bad_use(fmt::format("size {}: the largest sphere, {} of the cube's side, would not fit (allowed below 0.66)", format_number(options.relative_size),
                              format_number(options.relative_size * 1.5)));
  }
  std::uint64_t random = options.seed;
  spheres_.resize(options.sphere_count);
  for (std::size_t at = 0; at < spheres_.size(); ++at) {
    spheres_[at].radius_m = uniform(random, 0.5, 1.5) * options.relative_size * options.side_m / 2;
    spheres_[at].velocity = uniform_vector(random, options.speed_m_s);
    spheres_[at].spin = uniform_vector(random, options.spin_rad_s / std::sqrt(3.0));
    place(at, random);
  }
  ledger_.energy_before = energy(spheres_);
  ledger_.momentum_before = momentum(spheres_);
}

void Bounce::place(std::size_t sphere, std::uint64_t& random) {
  Sphere& placed = spheres_[sphere];
  for (int trial = 0; trial < kMostPlacements; ++trial) {
    placed.position = uniform_vector(random, options_.side_m / 2 - placed.radius_m);
    const bool is_free = std::none_of(spheres_.begin(), spheres_.begin() + static_cast<std::ptrdiff_t>(sphere), [&](const Sphere& other) {
      return (other.position - placed.position).norm() <= other.radius_m + placed.radius_m;
    });
    if (is_free) return;
  }
  ++overlapping_at_start_;
}

void Bounce::contact_began(std::size_t a, std::size_t b) {
  const bool is_new = a != b && open_.emplace(std::minmax(a, b), 0).second;
  if (is_new) ++ledger_.contacts;
}

void Bounce::contact_ended(std::size_t a, std::size_t b) {
  const auto found = open_.find(std::minmax(a, b));
  if (found == open_.end()) return;
  end_episode(found->second);
  open_.erase(found);
}

void Bounce::end_episode(std::uint64_t flips) {
  if (flips >= kStickingFlips) ++ledger_.sticking;
  ledger_.longest_flips = std::max(ledger_.longest_flips, flips);
}

void Bounce::touched_cube(std::size_t sphere, const Vec3& normal) {
  ++ledger_.cube_contacts;
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  // The walls' own reflection may have come first: only a sphere still on its way out turns.
  Sphere& touching = spheres_[sphere];
  if (touching.position[axis] * touching.velocity[axis] > 0) touching.velocity[axis] = -touching.velocity[axis];
}

void Bounce::flip_contacts() {
  for (auto& [pair, flips] : open_) {
    if (!options_.as_asked && flips > 0) continue;
    spheres_[pair.first].velocity = -spheres_[pair.first].velocity;
    spheres_[pair.second].velocity = -spheres_[pair.second].velocity;
    ++flips;
    ++ledger_.flips;
  }
}

void Bounce::reflect(Sphere& sphere) {
  const double most = options_.side_m / 2 - sphere.radius_m;
  std::size_t components = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double& at = sphere.position[axis];
    // A step may cross the cube many times: whole periods first, so that the loop ends after two turns.
    if (std::abs(at) > 4 * most) at = std::remainder(at, 4 * most);
    bool turned = false;
    for (int turn = 0; turn < 4 && std::abs(at) > most; ++turn) {
      at = at > 0 ? 2 * most - at : -2 * most - at;
      sphere.velocity[axis] = -sphere.velocity[axis];
      turned = true;
    }
    at = std::clamp(at, -most, most);
    if (turned) ++components;
  }
  if (components > 0) ++ledger_.wall_hits[components];
}

void Bounce::step(double seconds) {
  ++ledger_.steps;
  flip_contacts();
  for (Sphere& sphere : spheres_) {
    sphere.position += sphere.velocity * seconds;
    reflect(sphere);
    const double turn = sphere.spin.norm() * seconds;
    if (turn > 0) sphere.rotation = (Quat(Eigen::AngleAxisd(turn, sphere.spin.normalized())) * sphere.rotation).normalized();
  }
}

BounceLedger Bounce::ledger() const {
  BounceLedger result = ledger_;
  // Episodes that still hold count with what they have done so far.
  for (const auto& [pair, flips] : open_) {
    if (flips >= kStickingFlips) ++result.sticking;
    result.longest_flips = std::max(result.longest_flips, flips);
  }
  result.energy_after = energy(spheres_);
  result.momentum_after = momentum(spheres_);
  return result;
}

std::array<std::size_t, 8> Bounce::size_histogram() const {
  std::array<std::size_t, 8> counts{};
  const double mean = options_.relative_size * options_.side_m / 2;
  for (const Sphere& sphere : spheres_) {
    const auto index = static_cast<std::size_t>(std::clamp((sphere.radius_m / mean - 0.5) * 8, 0.0, 7.0));
    ++counts[index];
  }
  return counts;
}

}  // namespace collided::cli
