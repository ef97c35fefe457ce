#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/oracle/seed.hpp"
#include "tests/studies/response/contact_solve.hpp"
#include "tests/studies/response/stepper.hpp"

namespace collided::response {
namespace {

/// The slow twin: every set of pushing contacts is tried, each by a dense solution, until one fits.
/// Returns forces and fails the test if none or two fit.
Eigen::VectorXd forces_by_enumeration(const Line& line, const Spring& spring, double h, const Motion& from) {
  const auto contacts = static_cast<Eigen::Index>(line.size() + 1);
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(contacts, contacts - 1);
  Eigen::MatrixXd inverse_mass = Eigen::MatrixXd::Zero(contacts - 1, contacts - 1);
  Eigen::VectorXd need(contacts);
  Eigen::VectorXd slack(contacts);
  for (Eigen::Index c = 0; c < contacts; ++c) {
    const auto contact = static_cast<std::size_t>(c);
    if (c < contacts - 1) {
      pull(c, c) = 1;
      inverse_mass(c, c) = 1 / line.mass_kg[contact];
    }
    if (c > 0) pull(c, c - 1) = -1;
    const double damper = spring.damping(line.reduced_mass(contact)) / h;
    const double open_m = gap(line, from.position_m, contact);
    slack[c] = 1 / (spring.stiffness_n_m + damper);
    need[c] = -(open_m + h * gap_rate(line, from.velocity_m_s, contact)) - std::max(-open_m, 0.0) * damper * slack[c];
  }
  const Eigen::MatrixXd matrix = h * h * pull * inverse_mass * pull.transpose() + Eigen::MatrixXd(slack.asDiagonal());
  int found = 0;
  Eigen::VectorXd answer = Eigen::VectorXd::Zero(contacts);
  for (unsigned set = 0; set < (1U << contacts); ++set) {
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(contacts, contacts);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(contacts);
    for (Eigen::Index c = 0; c < contacts; ++c) {
      if ((set >> c & 1U) == 0) continue;
      system.row(c) = matrix.row(c);
      right[c] = need[c];
    }
    const Eigen::VectorXd force = system.fullPivLu().solve(right);
    const Eigen::VectorXd over = need - matrix * force;
    bool fits = true;
    for (Eigen::Index c = 0; c < contacts; ++c) fits = fits && ((set >> c & 1U) != 0 ? force[c] > 0 : over[c] <= 0);
    if (!fits) continue;
    answer = force;
    ++found;
  }
  EXPECT_EQ(found, 1);
  return answer;
}

TEST(ResponseContactSolve, EqualsTheOnlySetOfContactsThatFits) {
  std::mt19937_64 random = oracle::seeded(20);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t pushing = 0;
  for (int trial = 0; trial < 2'000; ++trial) {
    Line line{{}, {}, 0, 0, 2.2};
    Motion motion;
    for (int body = 0; body < 4; ++body) {
      line.mass_kg.push_back(std::pow(10, 2 * unit(random)));
      line.radius_m.push_back(0.25);
      motion.position_m.push_back(0.3 + 0.53 * body + 0.1 * unit(random));
      motion.velocity_m_s.push_back(unit(random));
    }
    const Spring spring{.stiffness_n_m = std::pow(10, 3 + 2 * unit(random)), .damping_ratio = trial % 2 == 0 ? 0 : 0.3};
    const double h = std::pow(10, -1.5 + unit(random));
    const Eigen::VectorXd expected = forces_by_enumeration(line, spring, h, motion);
    ContactSolve solve;
    solve.stage(line, spring, h, motion);
    for (Eigen::Index c = 0; c < expected.size(); ++c) {
      EXPECT_NEAR(solve.force()[static_cast<std::size_t>(c)], expected[c], 1e-9 * (1 + expected.maxCoeff())) << trial;
      pushing += expected[c] > 0;
    }
  }
  EXPECT_GT(pushing, 2'000U);
}

// The stage's own equation, where no dense solution has digits left: masses and stiffness fifteen decades apart.
TEST(ResponseContactSolve, ForcesBearTheWeightAtAnyStiffness) {
  for (double stiffness = 1e2; stiffness < 1e15; stiffness *= 10) {
    for (const double h : {1e-6, 1e-3, 1.0}) {
      const Line line{{1, 1e-6, 1e6}, {0.1, 0.1, 0.1}, -10, 0};
      Motion motion{{-1, -0.9, -0.8}, {0, 0, 0}};
      const double weight = 10 * (1e6 + 1e-6 + 1);
      // At rest at their depths, so that the stage must find the weights and change nothing.
      motion.position_m[0] = 0.1 - weight / stiffness;
      motion.position_m[1] = motion.position_m[0] + 0.2 - 10 * (1e6 + 1e-6) / stiffness;
      motion.position_m[2] = motion.position_m[1] + 0.2 - 10 * 1e6 / stiffness;
      for (double& velocity : motion.velocity_m_s) velocity -= 10 * h;
      ContactSolve solve;
      solve.stage(line, {.stiffness_n_m = stiffness}, h, motion);
      // Depths are known to an ulp of the positions, about 1e5 m on the softest springs.
      const double rounding_n = stiffness * 4e-16 * (1 + 3 * weight / stiffness);
      EXPECT_NEAR(solve.force()[0], weight, 1e-14 * weight + rounding_n) << stiffness << ' ' << h;
      EXPECT_NEAR(solve.force()[2], 1e7, 1e-14 * weight + rounding_n) << stiffness << ' ' << h;
    }
  }
}

TEST(ResponseContactSolve, StoppingLeavesNobodyApproachingAndKeepsMomentum) {
  const Line line{{1, 2, 3, 4}, {0.5, 0.5, 0.5, 0.5}};
  std::vector<double> velocity{4, 1, -2, -1};
  ContactSolve solve;
  solve.stop(line, {0, 1, 1, 1, 0}, velocity);
  for (std::size_t contact = 1; contact < 4; ++contact) EXPECT_GE(gap_rate(line, velocity, contact), -1e-15);
  EXPECT_NEAR(velocity[0] + 2 * velocity[1] + 3 * velocity[2] + 4 * velocity[3], -4, 1e-14);
  // 4 + 2 - 6 = 0 of six kilograms stop, and the last, at -1, runs into them: -0.4 for all.
  for (const double each : velocity) EXPECT_NEAR(each, -0.4, 1e-15);
}

}  // namespace
}  // namespace collided::response
