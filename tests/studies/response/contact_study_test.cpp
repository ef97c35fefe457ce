#include "tests/studies/response/contact_study.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/studies/response/integrators.hpp"

namespace collided::response {
namespace {

const std::vector<ContactRow>& rows() {
  static const std::vector<ContactRow> all = contact_rows({.seed = 3, .starts = 3, .most_halvings = 14});
  return all;
}

std::vector<ContactRow> of(const std::string& integrator, double stiffness) {
  std::vector<ContactRow> chosen;
  std::copy_if(rows().begin(), rows().end(), std::back_inserter(chosen), [&](const ContactRow& row) {
    return row.integrator == integrator && std::abs(row.stiffness_n_m / stiffness - 1) < 1e-9;
  });
  return chosen;
}

// Up to 45 degrees aside, at three frame rates: 0.7 % below the law on the softest spring, where the line of centres turns most.
TEST(ContactStudy, PublishedSpheresFollowTheLawAtEveryStiffness) {
  for (int decade = 2; decade <= 12; ++decade) {
    const std::vector<ContactRow> spheres = of("spheres", std::pow(10, decade));
    ASSERT_EQ(spheres.size(), 3U);
    for (const ContactRow& row : spheres) {
      EXPECT_NEAR(row.penetration_m / row.law_m, 1, 0.1) << decade << ' ' << row.dt_s;
      EXPECT_LT(row.error, 1e-4) << decade << ' ' << row.dt_s;
      EXPECT_LT(row.energy_drift, 1e-8) << decade << ' ' << row.dt_s;
      EXPECT_NEAR(row.penetration_m, spheres.front().penetration_m, 1e-4 * row.penetration_m)
          << decade << ' ' << row.dt_s;
    }
  }
}

TEST(ContactStudy, TheClosedFormIsRightAtAnyStepAndCostsNoMoreWhereItIsStiff) {
  for (const double stiffness : {1e2, 1e7, 1e12}) {
    for (const ContactRow& row : of("closed_form", stiffness)) {
      EXPECT_LT(row.error, 1e-4) << stiffness << ' ' << row.dt_s;
      EXPECT_LT(row.energy_drift, 1e-8) << stiffness << ' ' << row.dt_s;
      EXPECT_NEAR(row.penetration_m / row.law_m, 1, 0.1) << stiffness << ' ' << row.dt_s;
    }
  }
}

// What the closed form is for: at a frame's step the others are wrong by all there is, on the stiffest spring still at a millionth of it.
TEST(ContactStudy, SteppingMethodsNeedStepsBelowTheContact) {
  for (const char* integrator : {"explicit_euler", "velocity_verlet", "implicit_euler"}) {
    EXPECT_GT(of(integrator, 1e12).front().error, 0.5) << integrator;
    EXPECT_GT(of(integrator, 1e12).back().error, 0.5) << integrator;
    const std::vector<ContactRow> soft = of(integrator, 1e2);
    EXPECT_LT(soft.back().error, 0.05) << integrator;
    EXPECT_NEAR(soft.back().penetration_m / soft.back().law_m, 1, 0.1) << integrator;
  }
}

// The orders that the literature gives them, within a contact: one for Euler, two for Verlet, and for the closed form's load. Across
// a touch that falls anywhere in a step, an order is only the least.
TEST(ContactStudy, ErrorsFallAsTheOrdersSay) {
  const SpringPair pair{.stiffness_n_m = 1e2, .reduced_mass_kg = 0.01, .length_m = 0.2};
  const RelativeMotion start{{0.15, 0.13, 0}, {-1, 0.2, 0}};
  const double seconds = 0.02;
  const RelativeMotion truth = true_motion(pair, start, seconds);
  ASSERT_LT(truth.place_m.norm(), pair.length_m);
  const int orders[]{1, 2, 1, 2};
  for (std::size_t at = 0; at < std::size(kIntegrators); ++at) {
    const auto error = [&](int steps) {
      RelativeMotion motion = start;
      for (int step = 0; step < steps; ++step) kIntegrators[at].step(pair, motion, seconds / steps);
      return (motion.place_m - truth.place_m).norm();
    };
    EXPECT_NEAR(std::log2(error(256) / error(1024)) / 2, orders[at], 0.05) << kIntegrators[at].name;
  }
}

// Head-on there is a formula: sine in the contact, and away with the speed of before.
TEST(ContactStudy, ItsTruthIsTheFormulaWhereThereIsOne) {
  const SpringPair pair{.stiffness_n_m = 1e4, .reduced_mass_kg = 0.01, .length_m = 0.2};
  const RelativeMotion start{{0.3, 0, 0}, {-2, 0, 0}};
  for (const double seconds : {0.04, 0.0507, 0.051, 0.1}) {
    const double since = seconds - 0.05;
    const double phase = since * 1e3;
    const double depth = since < 0                     ? 2 * since
                         : phase < 3.14159265358979324 ? 2e-3 * std::sin(phase)
                                                       : -2 * (since - 3.14159265358979324e-3);
    EXPECT_NEAR(true_motion(pair, start, seconds).place_m.x(), 0.2 - depth, 1e-15) << seconds;
  }
}

TEST(ContactStudy, TheTableHasEveryRow) {
  std::ostringstream text;
  write_csv(text, rows());
  const std::string table = text.str();
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), rows().size() + 1);
}

}  // namespace
}  // namespace collided::response
