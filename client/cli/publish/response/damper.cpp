#include "client/cli/publish/response/damper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "client/cli/publish/response/tolerance.hpp"

namespace collided::response {
namespace {

constexpr double kPi = std::numbers::pi;
// Near critical damping both forms divide by a difference that vanishes. It is kept this far from 0, which costs a
// relative error of 1e-10.
constexpr double kCriticalWidth = 1e-10;
constexpr double kLargestDampingRatio = 20;

/// 1 - ratio^2, kept away from 0.
double off_critical(double ratio) {
  const double off = (1 - ratio) * (1 + ratio);
  return std::abs(off) < kCriticalWidth ? kCriticalWidth : off;
}

/// The root of a function that falls from above 0 at `low` to below 0 at `high`, to the last bit.
template <typename Function>
double bisect(const Function& function, double low, double high) {
  for (double middle = low + (high - low) / 2; low < middle && middle < high; middle = low + (high - low) / 2) {
    (function(middle) > 0 ? low : high) = middle;
  }
  return high;
}

}  // namespace

double Spring::damping(double reduced_mass_kg) const {
  return 2 * damping_ratio * std::sqrt(stiffness_n_m * reduced_mass_kg);
}

double Spring::frequency(double reduced_mass_kg) const { return std::sqrt(stiffness_n_m / reduced_mass_kg); }

double restitution_of_damping(double damping_ratio) {
  const double off = off_critical(damping_ratio);
  const double root = std::sqrt(std::abs(off));
  // The time to the end of the contact times the damped frequency. The contact ends when the force, not the depth, is
  // 0.
  if (off > 0)
    return std::exp(-damping_ratio / root *
                    std::atan2(2 * damping_ratio * root, 2 * damping_ratio * damping_ratio - 1));
  return std::exp(-damping_ratio / root * 2 * std::asinh(root));
}

double damping_of_restitution(double restitution) {
  if (!(restitution >= kLeastDampedRestitution && restitution <= 1)) {
    throw std::invalid_argument(
        "restitution of a compliant contact: 0.001 to 1; a damper gives no less, an impulse does");
  }
  if (restitution == 1) return 0;
  return bisect([&](double ratio) { return restitution_of_damping(ratio) - restitution; }, 0, kLargestDampingRatio);
}

ContactPhase::ContactPhase(const Spring& spring, double reduced_mass_kg, double approach_m_s, double load_n,
                           double depth_m)
    : start_m_(depth_m), approach_m_s_(approach_m_s) {
  frequency_ = spring.frequency(reduced_mass_kg);
  decay_ = spring.damping_ratio * frequency_;
  const double off = off_critical(spring.damping_ratio);
  oscillates_ = off > 0;
  turn_ = frequency_ * std::sqrt(std::abs(off));
  rest_ = load_n / spring.stiffness_n_m;
  cosine_ = depth_m - rest_;
  sine_ = (approach_m_s + decay_ * cosine_) / turn_;
  duration_s_ = find_end();
}

double ContactPhase::depth(double seconds) const {
  if (oscillates_) {
    const double half = std::sin(turn_ * seconds / 2);
    const double kept = std::exp(-decay_ * seconds);
    // 1 - e^(-a) cos b without cancellation for short times.
    const double risen = -std::expm1(-decay_ * seconds) + kept * 2 * half * half;
    return rest_ * risen + kept * (start_m_ * std::cos(turn_ * seconds) + sine_ * std::sin(turn_ * seconds));
  }
  const double slow = std::exp((turn_ - decay_) * seconds) / 2;
  const double fast = std::exp((-turn_ - decay_) * seconds) / 2;
  return rest_ + cosine_ * (slow + fast) + sine_ * (slow - fast);
}

double ContactPhase::depth_rate(double seconds) const {
  // d/dt of e^(-at) (C cos + S sin).
  if (oscillates_) {
    return std::exp(-decay_ * seconds) * ((sine_ * turn_ - decay_ * cosine_) * std::cos(turn_ * seconds) -
                                          (cosine_ * turn_ + decay_ * sine_) * std::sin(turn_ * seconds));
  }
  const double slow = std::exp((turn_ - decay_) * seconds) / 2;
  const double fast = std::exp((-turn_ - decay_) * seconds) / 2;
  return (turn_ - decay_) * slow * (sine_ + cosine_) + (turn_ + decay_) * fast * (sine_ - cosine_);
}

double ContactPhase::force_over_mass(double seconds) const {
  return frequency_ * frequency_ * depth(seconds) + 2 * decay_ * depth_rate(seconds);
}

double ContactPhase::find_end() const {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  if (decay_ == 0) {
    // y = rest + A cos(theta - phase) falls through 0 where the cosine of theta - phase is -rest / A.
    const double sine2 = sine_ * sine_ + start_m_ * (start_m_ - 2 * rest_);  // A^2 - rest^2
    if (sine2 < 0 || (sine2 == 0 && rest_ >= 0)) return kEndless;
    return (std::atan2(sine_, cosine_) + std::atan2(std::sqrt(sine2), -rest_)) / turn_;
  }
  // The force is its value at rest plus e^(-at) times a wave. Its extremes are where tan(theta) is the quotient below.
  const double w2 = frequency_ * frequency_;
  const double p = 2 * decay_ * approach_m_s_ + w2 * cosine_;
  const double q = w2 * sine_ + 2 * decay_ * ((oscillates_ ? -cosine_ : cosine_) * turn_ - decay_ * sine_);
  const auto force = [this](double seconds) { return force_over_mass(seconds); };
  if (oscillates_) {
    double first = std::atan2(q * turn_ - decay_ * p, p * turn_ + decay_ * q);
    if (first <= 0) first += kPi;
    const double peak = first / turn_;
    const bool rises = force(peak) > force(0);
    const double low = rises ? peak : 0;
    const double least = rises ? peak + kPi / turn_ : peak;
    return force(least) < 0 ? bisect(force, low, least) : kEndless;
  }
  // The force is a sum of two falling exponentials, so it has at most one extreme.
  const double slow = (p + q) * (turn_ - decay_);
  const double fast = (p - q) * (turn_ + decay_);
  const double still = fast / slow > 0 ? std::log(fast / slow) / (2 * turn_) : 0;
  // After a thousand decay times only the load is left.
  if (still <= 0 || force(still) >= 0) return rest_ < 0 ? bisect(force, 0, 1e3 / (decay_ - turn_)) : kEndless;
  return bisect(force, 0, still);
}

double ContactPhase::deepest() const {
  // The rate is the approach times the cosine minus this times the sine; it is 0 and falling at atan2 of the two.
  if (oscillates_) {
    double angle = std::atan2(approach_m_s_, cosine_ * turn_ + decay_ * sine_);
    if (angle < 0) angle += 2 * kPi;
    return std::max(start_m_, depth(std::min(angle / turn_, duration_s_)));
  }
  const double slow = (turn_ - decay_) * (sine_ + cosine_);
  const double fast = (turn_ + decay_) * (sine_ - cosine_);
  const double quotient = -fast / slow;
  const double ends = std::max({rest_, start_m_, 0.0});
  // With no approach speed the quotient is 1. If rounding makes it larger, the time found is the start, where the rate
  // is 0.
  return quotient > 1 ? std::max(depth(std::min(std::log(quotient) / (2 * turn_), duration_s_)), ends) : ends;
}

}  // namespace collided::response
