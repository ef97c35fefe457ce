#include "client/cli/publish/response/spring_contact.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "client/cli/publish/response/tolerance.hpp"

namespace collided::response {
namespace {

constexpr double kPi = 3.14159265358979324;

/// Energy of the spring as it lies between the two, not as the run says, over the mass.
double energy(const Spring& spring, double mass_kg, double length_m, const RelativeMotion& motion) {
  const double depth = std::max(0.0, length_m - motion.place_m.norm());
  return 0.5 * motion.velocity_m_s.squaredNorm() + 0.5 * spring.stiffness_n_m / mass_kg * depth * depth;
}

// sqrt(m / k) v by hand, however the time is cut: the contact takes from half a minute's thousandth to a ten-millionth of a second.
TEST(ResponseSpringContact, HeadOnItIsAsDeepAsItsEnergySays) {
  for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
    for (const int cuts : {1, 7, 240}) {
      RelativeMotion motion{{0.3, 0, 0}, {-0.5, 0, 0}};
      double deepest = 0;
      for (int cut = 0; cut < cuts; ++cut) {
        const SpringRun run = move_on_spring({.stiffness_n_m = stiffness}, 0.01, 0.2, motion, 1.0 / cuts);
        deepest = std::max(deepest, run.deepest_m);
      }
      const double frequency = std::sqrt(stiffness / 0.01);
      EXPECT_NEAR(deepest, 0.5 / frequency, 1e-9 * 0.5 / frequency) << stiffness << ' ' << cuts;
      EXPECT_NEAR(motion.velocity_m_s.x(), 0.5, 1e-9) << stiffness << ' ' << cuts;
      EXPECT_NEAR(motion.place_m.x(), 0.2 + 0.5 * (1 - 0.2 - kPi / frequency), 1e-9) << stiffness << ' ' << cuts;
    }
  }
}

TEST(ResponseSpringContact, AnObliqueContactKeepsItsEnergy) {
  for (const double stiffness : {1.0, 1e2, 1e4, 1e8, 1e12}) {
    const Spring spring{.stiffness_n_m = stiffness};
    RelativeMotion motion{{0.25, 0.1, 0.05}, {-1, 0.2, 0.1}};
    const double before = energy(spring, 0.01, 0.2, motion);
    const Vec3 spun = motion.place_m.cross(motion.velocity_m_s);
    double pushed = 0;
    for (int step = 0; step < 60; ++step) {
      pushed += move_on_spring(spring, 0.01, 0.2, motion, 1.0 / 60).pushed ? 1 : 0;
      ASSERT_NEAR(energy(spring, 0.01, 0.2, motion) / before, 1, 1e-11) << stiffness << ' ' << step;
      ASSERT_NEAR((motion.place_m.cross(motion.velocity_m_s) - spun).norm(), 0, 1e-14) << stiffness;
    }
    EXPECT_GT(pushed, 0) << stiffness;
  }
}

/// The same motion by ten thousand steps of Verlet a contact.
RelativeMotion by_fine_steps(const Spring& spring, double mass_kg, double length_m, RelativeMotion motion,
                             double seconds) {
  const auto acceleration = [&](const Vec3& place) {
    const double distance = place.norm();
    return Vec3(spring.stiffness_n_m / mass_kg * std::max(0.0, length_m - distance) / distance * place);
  };
  const int steps = static_cast<int>(seconds / (kPi * std::sqrt(mass_kg / spring.stiffness_n_m)) * 1e4);
  const double h = seconds / steps;
  Vec3 pulled = acceleration(motion.place_m);
  for (int step = 0; step < steps; ++step) {
    motion.velocity_m_s += 0.5 * h * pulled;
    motion.place_m += h * motion.velocity_m_s;
    pulled = acceleration(motion.place_m);
    motion.velocity_m_s += 0.5 * h * pulled;
  }
  return motion;
}

// Softer springs let the line of centres turn by half a radian: that is where the load matters. Within the square of kMostTurn.
TEST(ResponseSpringContact, AnObliqueContactFollowsAFineStep) {
  for (const double stiffness : {1.0, 1e2, 1e4}) {
    for (const Vec3& start : {Vec3(0.25, 0.1, 0.05), Vec3(0.25, 0.02, 0), Vec3(0.25, -0.17, 0)}) {
      const Spring spring{.stiffness_n_m = stiffness};
      RelativeMotion motion{start, {-1, 0.2, 0.1}};
      const RelativeMotion fine = by_fine_steps(spring, 0.01, 0.2, motion, 0.5);
      move_on_spring(spring, 0.01, 0.2, motion, 0.5);
      EXPECT_NEAR((motion.place_m - fine.place_m).norm(), 0, kMostTurn * kMostTurn)
          << stiffness << ' ' << start.transpose();
      EXPECT_NEAR((motion.velocity_m_s - fine.velocity_m_s).norm(), 0, kMostTurn * kMostTurn)
          << stiffness << ' ' << start.transpose();
    }
  }
}

// A spring too soft for its bodies lets their centres meet, or all but meet: finite, ended, and no faster than they came.
TEST(ResponseSpringContact, CentresThatMeetComeToAnEnd) {
  for (const double aside : {0.0, 1e-12, 1e-3}) {
    RelativeMotion motion{{0.3, aside, 0}, {-100, 0, 0}};
    const SpringRun run = move_on_spring({.stiffness_n_m = 1e2}, 0.01, 0.2, motion, 1);
    EXPECT_TRUE(motion.place_m.allFinite()) << aside;
    EXPECT_LT(motion.velocity_m_s.norm(), 101) << aside;
    EXPECT_GT(run.deepest_m, 0.1) << aside;
  }
}

// A damper eases the spring: of restitution e the deepest is exp(-z acos(z) / sqrt(1 - z^2)) of the undamped, z the damping ratio.
TEST(ResponseSpringContact, ADamperMakesItShallowerByTheSameShareAtAnyStiffness) {
  for (const double restitution : {0.9, 0.5, 0.3}) {
    const double ratio = damping_of_restitution(restitution);
    for (double stiffness = 1e2; stiffness < 2e12; stiffness *= 10) {
      RelativeMotion motion{{0.3, 0, 0}, {-0.5, 0, 0}};
      const SpringRun run = move_on_spring({.stiffness_n_m = stiffness, .damping_ratio = ratio}, 0.01, 0.2, motion, 1);
      const double share = std::exp(-ratio / std::sqrt(1 - ratio * ratio) * std::acos(ratio));
      EXPECT_NEAR(run.deepest_m, share * 0.5 * std::sqrt(0.01 / stiffness), 1e-6 * run.deepest_m)
          << restitution << ' ' << stiffness;
      EXPECT_NEAR(motion.velocity_m_s.x(), 0.5 * restitution, 1e-9) << restitution << ' ' << stiffness;
    }
  }
}

// Between two walls a bounce is a contact and a flight: all of them, however many fall into the step.
TEST(ResponseSpringContact, BetweenWallsEveryBounceHasItsTime) {
  for (const double stiffness : {1e2, 1e6, 1e12}) {
    const double contact_s = kPi / std::sqrt(stiffness / 0.01);
    for (const int cuts : {1, 13}) {
      double position = 0.1, velocity = 3, deepest = 0;
      int began = 0;
      const double period = 4 * 0.25 / 3 + 2 * contact_s;
      for (int cut = 0; cut < cuts; ++cut) {
        const SpringRun run =
            move_between_springs({.stiffness_n_m = stiffness}, 0.01, 0.25, position, velocity, 20 * period / cuts);
        deepest = std::max(deepest, run.deepest_m);
        began += run.began ? 1 : 0;
      }
      EXPECT_NEAR(position, 0.1, 1e-9) << stiffness << ' ' << cuts;
      EXPECT_NEAR(velocity, 3, 1e-9) << stiffness << ' ' << cuts;
      EXPECT_NEAR(deepest / (3 * std::sqrt(0.01 / stiffness)), 1, 1e-9) << stiffness << ' ' << cuts;
      EXPECT_EQ(began, cuts);
    }
  }
}

TEST(ResponseSpringContact, AStepOfAMillionMillionBouncesEnds) {
  for (const double restitution : {1.0, 0.999}) {
    double position = 0.1, velocity = 1e12;
    move_between_springs({.stiffness_n_m = 1e12, .damping_ratio = damping_of_restitution(restitution)}, 0.01, 0.25,
                         position, velocity, 1);
    EXPECT_TRUE(std::isfinite(position));
    EXPECT_LE(std::abs(velocity), 1.0001e12);
  }
}

}  // namespace
}  // namespace collided::response
