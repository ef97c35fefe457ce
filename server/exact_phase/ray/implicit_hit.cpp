#include "server/exact_phase/ray/implicit_hit.hpp"

#include <cmath>
#include <limits>

#include "server/exact_phase/ray/ray_hit_value.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

double or_infinite(double bound) { return bound >= 0 ? bound : kEndless; }

/// Keeps the squares of a direction of 1e-200 from underflowing.
Scaled length_of_direction(const Ray& ray) {
  const double largest = ray.direction.cwiseAbs().maxCoeff();
  int power = 0;
  std::frexp(largest, &power);
  Bounded sum;
  for (const double component : ray.direction) {
    // Terms that underflow here are below 2^-1000 of the sum.
    const Bounded c(std::ldexp(component, -power));
    sum = sum + c * c;
  }
  return {engine::sqrt(sum + Bounded(0, kSmallestPlain)), power};
}

}  // namespace

void set_place(const Ray& ray, double low, double high, ImplicitHit& hit) {
  hit.low = low;
  hit.high = high;
  const double middle = std::isfinite(high) ? low + (high - low) / 2 : low;
  const Bounded t(middle, low == high ? 0.0
                                      : std::max(high - middle, middle - low) * (1 + kBoundSlack) +
                                            std::numeric_limits<double>::denorm_min());
  const Bounded distance = plain(Scaled{t, 0} * length_of_direction(ray));
  hit.distance_m = distance.value;
  hit.distance_error_m = or_infinite(distance.bound());
  double error = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Bounded on_ray = Bounded(ray.origin[axis]) + t * Bounded(ray.direction[axis]);
    hit.point[axis] = on_ray.value;
    error += on_ray.bound();
  }
  hit.point_error_m = or_infinite(error * (1 + kBoundSlack));
}

double set_normal(const Vector<Bounded>& slope, ImplicitHit& hit) {
  const Bounded length = engine::sqrt(square(slope));
  const Bounded unit[3] = {slope.x / length, slope.y / length, slope.z / length};
  const double error = or_infinite((unit[0].bound() + unit[1].bound() + unit[2].bound()) * (1 + kBoundSlack));
  const bool known = error < 1;
  hit.normal_state = known ? ImplicitHit::Normal::known : ImplicitHit::Normal::undecided;
  hit.normal = known ? Vec3(unit[0].value, unit[1].value, unit[2].value) : Vec3(Vec3::Zero());
  hit.normal_error = known ? error : kEndless;
  return hit.normal_error;
}

bool narrow_enough(const Ray& ray, double low, double high, double relative_width) {
  if (high - low <= relative_width * high || std::nextafter(low, kEndless) >= high) return true;
  if (precision.error_asked_m == 0) return false;
  const Bounded reach = plain(Scaled{Bounded(high - low), 0} * length_of_direction(ray));
  return reach.value + reach.bound() <= 2 * precision.error_asked_m;
}

}  // namespace collided::engine::kernel
