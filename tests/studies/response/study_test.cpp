#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/studies/response/response_study.hpp"

namespace collided::response {
namespace {

/// A small study: three stiffnesses, one step, from k dt^2 / m = 1e-4 to 1e6.
const std::vector<ResponseRow>& rows() {
  static const std::vector<ResponseRow> all = response_rows({.seed = 3, .starts = 2, .steps_s = {1e-3}});
  return all;
}

std::vector<ResponseRow> of(const std::string& scene, const std::string& method) {
  std::vector<ResponseRow> chosen;
  std::copy_if(rows().begin(), rows().end(), std::back_inserter(chosen),
               [&](const ResponseRow& row) { return row.scene == scene && row.method == method; });
  return chosen;
}

TEST(ResponseStudy, CoversFromAMillionthToAMillion) {
  const std::vector<ResponseRow> ball = of("ball", "compliant");
  ASSERT_EQ(ball.size(), 11U);
  EXPECT_NEAR(ball.front().stiffness_ratio, 1e-4, 1e-12);
  EXPECT_NEAR(ball.back().stiffness_ratio, 1e6, 1);
  const StudyOptions whole;
  EXPECT_LE(whole.least_stiffness_n_m * std::pow(whole.steps_s.front(), 2), 1.0001e-6);
}

// Ceilings of one significant digit over what is observed.
TEST(ResponseStudy, TheCompliantMethodHoldsOnEveryScene) {
  for (const ResponseRow& row : rows()) {
    if (row.method != "compliant") continue;
    EXPECT_FALSE(row.exploded) << row.scene << row.stiffness_n_m;
    EXPECT_LE(row.energy_drift, 4e-7) << row.scene << row.stiffness_n_m;
    EXPECT_EQ(row.missed, 0U) << row.scene << row.stiffness_n_m;
    EXPECT_EQ(row.spurious, 0U) << row.scene << row.stiffness_n_m;
    if (row.scene == "cradle") continue;  // its reference is rigid
    EXPECT_LE(row.error_m, 1e-5) << row.scene << row.stiffness_n_m;
    EXPECT_NEAR(row.penetration_m / row.penetration_bound_m, 1, 0.01) << row.scene << row.stiffness_n_m;
  }
}

TEST(ResponseStudy, PenetrationAtRestIsTheLoadOverTheStiffness) {
  for (const char* scene : {"resting", "stack"}) {
    const double load = std::string(scene) == "stack" ? 98.1 : 9.81;
    for (const ResponseRow& row : of(scene, "compliant"))
      EXPECT_NEAR(row.penetration_bound_m, load / row.stiffness_n_m, 1e-9 * load / row.stiffness_n_m);
  }
}

// A fall does not end in the swing that the limit of 4 is about, so that a ball may lose or gain before: but beyond, it explodes.
TEST(ResponseStudy, ExplicitMethodsExplodeBeyondTheirLimit) {
  for (const char* scene : {"ball", "resting", "stack", "cradle"}) {
    for (const ResponseRow& row : of(scene, "semi_implicit_euler")) {
      if (row.stiffness_ratio > 4) {
        EXPECT_TRUE(row.exploded) << scene << row.stiffness_ratio;
      } else if (row.stiffness_ratio <= 0.1) {
        EXPECT_FALSE(row.exploded) << scene << row.stiffness_ratio;
      }
    }
    for (const ResponseRow& row : of(scene, "explicit_euler")) {
      if (row.stiffness_ratio > 4) { EXPECT_TRUE(row.exploded) << scene << row.stiffness_ratio; }
    }
  }
}

TEST(ResponseStudy, ImplicitEulerNeitherExplodesNorBounces) {
  for (const ResponseRow& row : of("ball", "implicit_euler")) {
    EXPECT_FALSE(row.exploded);
    if (row.stiffness_ratio >= 1) { EXPECT_GT(row.energy_drift, 0.9); }
  }
}

TEST(ResponseStudy, EventDrivenIsTheClosedForm) {
  for (const char* scene : {"ball", "resting", "stack", "pair", "cradle"}) {
    for (const ResponseRow& row : of(scene, "event_driven")) {
      EXPECT_LE(row.error_m, 1e-12) << scene;
      EXPECT_EQ(row.missed + row.spurious, 0U) << scene;
    }
  }
}

TEST(ResponseStudy, TheSameSeedIsTheSameStudyAndTheTableHasAllOfIt) {
  const StudyOptions small{
      .seed = 5, .starts = 1, .least_stiffness_n_m = 1e6, .largest_stiffness_n_m = 1e6, .steps_s = {1e-2}};
  const std::vector<ResponseRow> one = response_rows(small);
  const std::vector<ResponseRow> two = response_rows(small);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t at = 0; at < one.size(); ++at) {
    EXPECT_EQ(one[at].error_m, two[at].error_m);
    EXPECT_EQ(one[at].energy_drift, two[at].energy_drift);
    EXPECT_GT(one[at].ns_per_step, 0);
  }
  std::ostringstream text;
  write_csv(text, one);
  const std::string table = text.str();
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), one.size() + 1);
}

}  // namespace
}  // namespace collided::response
