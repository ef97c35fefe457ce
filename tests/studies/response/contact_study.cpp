#include "tests/studies/response/contact_study.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>
#include <random>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "client/cli/publish/response/spheres.hpp"
#include "tests/studies/response/integrators.hpp"

namespace collided::response {
namespace {

constexpr double kFrame_s = 1.0 / 60;
constexpr double kRadius_m[]{0.12, 0.08};
using Clock = std::chrono::steady_clock;

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Sphere sphere_of(double radius_m, const Vec3& place, const Vec3& velocity) {
  return {.radius_m = radius_m, .position = place, .velocity = velocity, .spin = Vec3::Zero()};
}

/// Two spheres that touch in the first half of a frame, up to 45 degrees aside.
struct Start {
  SpringPair pair;
  RelativeMotion motion;
  double touch_s = 0;
  double law_m = 0;
  RelativeMotion truth;  // at the frame's end; dearer than most of what is compared with it

  Start(std::mt19937_64& random, double stiffness) {
    const double mass_a = kRadius_m[0] * kRadius_m[0] * kRadius_m[0],
                 mass_b = kRadius_m[1] * kRadius_m[1] * kRadius_m[1];
    pair = {.stiffness_n_m = stiffness,
            .reduced_mass_kg = 1 / (1 / mass_a + 1 / mass_b),
            .length_m = kRadius_m[0] + kRadius_m[1]};
    const double angle = uniform(random, -0.8, 0.8), speed = uniform(random, 0.5, 2);
    touch_s = uniform(random, 0.1, 0.5) * kFrame_s;
    const Vec3 line(std::cos(angle), std::sin(angle), 0);
    motion.velocity_m_s = Vec3(-speed, 0, 0);
    motion.place_m = pair.length_m * line - touch_s * motion.velocity_m_s;
    law_m = speed * std::cos(angle) * std::sqrt(pair.reduced_mass_kg / stiffness);
    truth = true_motion(pair, motion, kFrame_s);
  }
};

double error_of(const SpringPair& pair, const RelativeMotion& found, const RelativeMotion& truth) {
  const double place = (found.place_m - truth.place_m).norm() / pair.length_m;
  const double velocity = (found.velocity_m_s - truth.velocity_m_s).norm() / truth.velocity_m_s.norm();
  const double error = std::max(place, velocity);
  return std::isfinite(error) ? error : INFINITY;
}

/// The row of the starts' worst; the time is their median.
class Worst {
 public:
  explicit Worst(ContactRow row) : row_(std::move(row)) {}
  void add(double error, double drift, double penetration_m, double law_m, double ns) {
    row_.error = std::max(row_.error, error);
    row_.energy_drift = std::max(row_.energy_drift, std::isfinite(drift) ? drift : INFINITY);
    const bool is_farther = row_.law_m == 0 || std::abs(std::log(penetration_m / law_m)) >
                                                   std::abs(std::log(row_.penetration_m / row_.law_m));
    if (is_farther || !(penetration_m > 0)) {
      row_.penetration_m = penetration_m;
      row_.law_m = law_m;
    }
    times_.push_back(ns);
  }
  ContactRow row() {
    std::nth_element(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(times_.size() / 2), times_.end());
    row_.ns = times_[times_.size() / 2];
    return row_;
  }

 private:
  ContactRow row_;
  std::vector<double> times_;
};

void run_integrator(Worst& worst, const Start& start, Integrator step, int steps) {
  const double h = kFrame_s / steps;
  RelativeMotion motion = start.motion;
  const Clock::time_point begun = Clock::now();
  for (int at = 0; at < steps; ++at) step(start.pair, motion, h);
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - begun).count();
  const double error = error_of(start.pair, motion, start.truth);
  // Once more for what is to be seen on the way, which must not count as time of the method.
  motion = start.motion;
  const double before = start.pair.energy(motion);
  double drift = 0, deepest = 0;
  const Spring spring{.stiffness_n_m = start.pair.stiffness_n_m};
  for (int at = 0; at < steps; ++at) {
    double inside = 0;  // of a contact that the closed form begins and ends in the step
    if (step == closed_form)
      inside = move_on_spring(spring, start.pair.reduced_mass_kg, start.pair.length_m, motion, h).deepest_m;
    else step(start.pair, motion, h);
    deepest = std::max({deepest, inside, start.pair.length_m - motion.place_m.norm()});
    drift = std::max(drift, std::abs(start.pair.energy(motion) / before - 1));
  }
  worst.add(error, drift, deepest, start.law_m, ns);
}

/// As `collide publish --spheres` moves them: frame by frame, told of the touch after the frame in which it was, whose bracket is a
/// microsecond wide.
void run_spheres(Worst& worst, const Start& start, double rate_hz) {
  const double frame_s = 1 / rate_hz;
  const auto frames = static_cast<int>(std::ceil(2 * kFrame_s * rate_hz));
  Spheres spheres({.answer = ResponseLaw::compliant, .half_side_m = 100, .stiffness_n_m = start.pair.stiffness_n_m},
                  {sphere_of(kRadius_m[0], Vec3::Zero(), -0.5 * start.motion.velocity_m_s),
                   sphere_of(kRadius_m[1], start.motion.place_m, 0.5 * start.motion.velocity_m_s)});
  const auto between = [&]() -> RelativeMotion {
    const Sphere& a = spheres.spheres()[0];
    const Sphere& b = spheres.spheres()[1];
    return {b.position - a.position, b.velocity - a.velocity};
  };
  const double before = start.pair.energy(start.motion);
  double drift = 0;
  bool is_told = false;
  const Clock::time_point begun = Clock::now();
  for (int frame = 0; frame < frames; ++frame) {
    const double now = frame * frame_s;
    if (!is_told && now >= start.touch_s) {
      is_told = true;
      const double ago = now - start.touch_s;
      const double depth_m = start.pair.length_m - between().place_m.norm();
      spheres.contact_began(
          0, 1, {.earliest_s = ago + 5e-7, .latest_s = std::max(0.0, ago - 5e-7), .seen_s = 0, .depth_m = depth_m});
    }
    spheres.step(frame_s);
    if (is_told) drift = std::max(drift, std::abs(start.pair.energy(between()) / before - 1));
  }
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - begun).count() / frames;
  worst.add(error_of(start.pair, between(), true_motion(start.pair, start.motion, frames * frame_s)), drift,
            spheres.ledger().penetration_m, start.law_m, ns);
}

std::vector<Start> starts_of(const ContactStudyOptions& options, double stiffness) {
  std::mt19937_64 random(options.seed);
  std::vector<Start> starts;
  for (int start = 0; start < options.starts; ++start) starts.emplace_back(random, stiffness);
  return starts;
}

}  // namespace

std::vector<ContactRow> contact_rows(const ContactStudyOptions& options) {
  std::vector<ContactRow> rows;
  for (int decade = 2; decade <= 12; ++decade) {
    const double stiffness = std::pow(10, decade);
    const std::vector<Start> starts = starts_of(options, stiffness);
    const int most_halvings = decade % 5 == 2 ? options.most_halvings : options.most_halvings / 2;
    for (const auto& [name, step] : kIntegrators) {
      for (int halvings = 0; halvings <= most_halvings; halvings += 2) {
        const int steps = 1 << halvings;
        Worst worst({.integrator = std::string(name), .stiffness_n_m = stiffness, .dt_s = kFrame_s / steps});
        for (const Start& start : starts) run_integrator(worst, start, step, steps);
        rows.push_back(worst.row());
      }
    }
    for (const double rate_hz : {60.0, 120.0, 240.0}) {
      Worst worst({.integrator = "spheres", .stiffness_n_m = stiffness, .dt_s = 1 / rate_hz});
      for (const Start& start : starts) run_spheres(worst, start, rate_hz);
      rows.push_back(worst.row());
    }
  }
  return rows;
}

void write_csv(std::ostream& out, const std::vector<ContactRow>& rows) {
  out << "integrator,stiffness_n_m,dt_s,error,energy_drift,penetration_m,law_m,penetration_over_law,ns\n";
  for (const ContactRow& row : rows) {
    out << fmt::format("{},{},{:.4g},{:.3g},{:.3g},{:.4g},{:.4g},{:.4f},{:.0f}\n", row.integrator, row.stiffness_n_m,
                       row.dt_s, row.error, row.energy_drift, row.penetration_m, row.law_m,
                       row.penetration_m / row.law_m, row.ns);
  }
}

}  // namespace collided::response
