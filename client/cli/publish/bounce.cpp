#include "client/cli/publish/bounce.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

/// The next random number; the same sequence on every machine.
/// source  Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014 (SplitMix64)
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

/// A random number, uniform in [low, high); unlike with std's distributions, the same on every machine.
double uniform(std::uint64_t& state, double low, double high) {
  constexpr double kStep = 0x1p-53;  // of 53 random bits, as a number in [0, 1)
  const double unit = static_cast<double>(next_random(state) >> 11) * kStep;
  return low + (high - low) * unit;
}

Vec3 uniform_vector(std::uint64_t& state, double most) {
  const double x = uniform(state, -most, most);
  const double y = uniform(state, -most, most);
  const double z = uniform(state, -most, most);
  return {x, y, z};
}

constexpr int kMostPlacements = 1'000;

}  // namespace

Bounce::Bounce(const BounceOptions& options) : options_(options) {
  const double largest_radius = options.relative_size * options.side_m * 0.75;
  if (!(largest_radius * 2 < options.side_m)) {
    throw bad_use(fmt::format("size {}: the largest sphere, {} of the cube's side, would not fit (allowed below 0.66)",
                              format_number(options.relative_size), format_number(options.relative_size * 1.5)));
  }
  std::uint64_t random = options.seed;
  std::vector<Sphere> spheres(options.sphere_count);
  for (std::size_t at = 0; at < spheres.size(); ++at) {
    spheres[at].radius_m = uniform(random, 0.5, 1.5) * options.relative_size * options.side_m / 2;
    spheres[at].velocity = uniform_vector(random, options.speed_m_s);
    spheres[at].spin = uniform_vector(random, options.spin_rad_s / std::sqrt(3.0));
    place(spheres, at, random);
  }
  response::SphereOptions response;
  response.answer = options.answer;
  response.every_frame = options.as_asked;
  response.half_side_m = options.side_m / 2;
  response.restitution = options.restitution;
  response.stiffness_n_m = options.stiffness_n_m;
  try {
    response_ = response::Spheres(response, std::move(spheres));
  } catch (const std::invalid_argument& wrong) { throw bad_use(wrong.what()); }
}

void Bounce::place(std::vector<Sphere>& spheres, std::size_t sphere, std::uint64_t& random) {
  Sphere& placed = spheres[sphere];
  for (int trial = 0; trial < kMostPlacements; ++trial) {
    placed.position = uniform_vector(random, options_.side_m / 2 - placed.radius_m);
    const bool is_free =
        std::none_of(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(sphere), [&](const Sphere& other) {
          return (other.position - placed.position).norm() <= other.radius_m + placed.radius_m;
        });
    if (is_free) return;
  }
  ++overlapping_at_start_;
}

std::array<std::size_t, 8> Bounce::size_histogram() const {
  std::array<std::size_t, 8> counts{};
  const double mean = options_.relative_size * options_.side_m / 2;
  for (const Sphere& sphere : spheres()) {
    const auto index = static_cast<std::size_t>(std::clamp((sphere.radius_m / mean - 0.5) * 8, 0.0, 7.0));
    ++counts[index];
  }
  return counts;
}

}  // namespace collided::cli
