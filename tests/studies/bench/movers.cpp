#include "tests/studies/bench/movers.hpp"

#include <cmath>

namespace collided::bench {
using namespace engine;

using Uniform = std::uniform_real_distribution<double>;

Vec3 Movers::any(Uniform of) {
  const double x = of(random_);
  const double y = of(random_);
  return {x, y, of(random_)};
}

Vec3 Movers::any_place() { return any(Uniform(0, 1)).cwiseProduct(edges_m_); }

namespace {

/// Ten cubic metres for each.
Vec3 edges_of(std::size_t count, const std::string& kind) {
  const double volume_m3 = 10.0 * static_cast<double>(count);
  if (kind == "in a line") return {volume_m3 / 4, 2, 2};
  return Vec3::Constant(std::cbrt(volume_m3));
}

}  // namespace

Movers::Movers(std::size_t count, const std::string& kind, Motion motion, std::mt19937_64& random)
    : edges_m_(edges_of(count, kind)), motion_(motion), random_(random) {
  const double size_range = kind == "sizes 1/8 to 8" ? 8 : 1;
  Uniform size(1 / size_range, size_range);
  std::normal_distribution<double> spread(0, 2.5);
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  Vec3 middle = any_place();
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 low = any_place();
    Vec3 extent = Vec3::Constant(size(random_));
    if (kind == "clustered") {
      if (i % 100 == 0) middle = any_place();
      const double x = spread(random_);
      const double y = spread(random_);
      low = middle + Vec3(x, y, spread(random_));
    } else if (kind == "in one cell") {
      const double pitch = 1 / static_cast<double>(side);
      low = pitch * Vec3(0, static_cast<double>(i % side), static_cast<double>(i / side));
      extent = Vec3(1, 0.5 * pitch, 0.5 * pitch);
    } else if (kind == "in one point") {
      low = Vec3::Zero();
    }
    boxes_.push_back({low, low + extent});
    const bool rests = kind.starts_with("in one");
    velocities_.push_back(rests ? Vec3(Vec3::Zero()) : any(Uniform(-0.1, 0.1)));
  }
  if (kind == "one giant") {
    boxes_.front() = {Vec3::Zero(), edges_m_};
    velocities_.front().setZero();
  }
}

void Movers::fly(std::size_t i) {
  Vec3& velocity = velocities_[i];
  for (int k = 0; k < 3; ++k) {
    const double next = boxes_[i].low[k] + velocity[k];
    // Back towards the cube also for those that began outside of it.
    if (next < 0) velocity[k] = std::abs(velocity[k]);
    if (next > edges_m_[k]) velocity[k] = -std::abs(velocity[k]);
  }
  boxes_[i].low += velocity;
  boxes_[i].high += velocity;
}

void Movers::step() {
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (motion_ == Motion::flight) {
      fly(i);
    } else {
      const Vec3 extent = boxes_[i].high - boxes_[i].low;
      boxes_[i].low = any_place();
      boxes_[i].high = boxes_[i].low + extent;
    }
  }
}

}  // namespace collided::bench
