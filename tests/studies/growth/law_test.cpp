#include "tests/studies/growth/law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/studies/growth/engine_laws.hpp"
#include "tests/studies/growth/service_laws.hpp"

namespace collided::growth {
namespace {

Law law_of(const std::vector<double>& x, double (*value)(double), Theory theory) {
  Law law{.knob = "things", .what = "work", .unit = "ns", .theory = theory, .reason = "named here"};
  for (const double size : x) law.samples.push_back(sample_of(size, {value(size)}));
  return law;
}

// Linear growth on top of a thousand that anything costs: only the upper half shows the law.
TEST(GrowthLaw, WhatAnythingCostsDoesNotHideTheLaw) {
  const Law law = law_of(half_decades(100, 1e6), [](double x) { return 1'000 + x; }, {1});
  const Judgement judgement = judge(law);
  EXPECT_LT(judgement.all.exponent, 0.9);
  EXPECT_NEAR(judgement.upper.exponent, 1, 0.05);
  EXPECT_FALSE(judgement.deviates);
}

TEST(GrowthLaw, ALogarithmIsKnownFromASmallPower) {
  const std::vector<double> sizes = half_decades(1'000, 1e7);
  EXPECT_NEAR(judge(law_of(sizes, [](double x) { return x * std::log(x); }, {1, true})).deviation, 0, 1e-9);
  EXPECT_TRUE(judge(law_of(sizes, [](double x) { return std::pow(x, 0.3); }, {0, true})).deviates);
}

TEST(GrowthLaw, ADeviationIsNamedInTheTable) {
  const std::vector<double> sizes = half_decades(100, 1e6);
  const std::string steep = table({law_of(sizes, [](double x) { return x * x; }, {1})});
  EXPECT_NE(steep.find("steeper than theory by 1.00: named here"), std::string::npos) << steep;
  const std::string right = table({law_of(sizes, [](double x) { return x; }, {1})});
  EXPECT_EQ(right.find("than theory"), std::string::npos) << right;
}

TEST(GrowthLaw, OfTwoSizesNothingIsSaid) {
  const std::string few = table({law_of({100, 1'000}, [](double x) { return x * x; }, {1})});
  EXPECT_NE(few.find("not judged"), std::string::npos) << few;
}

TEST(GrowthLaw, TheSpreadOfRepeatsIsKept) {
  const Sample sample = sample_of(7, {3, 1, 2});
  EXPECT_EQ(sample.low, 1);
  EXPECT_EQ(sample.median, 2);
  EXPECT_EQ(sample.high, 3);
}

TEST(GrowthLaw, AForeignLineIsNoMeasurement) {
  EXPECT_EQ(service_laws("0 4 1 2 3\n")[0].samples.front().median, 2);
  EXPECT_THROW(service_laws("0 4 1\n"), std::runtime_error);
  EXPECT_THROW(service_laws("9 4 1 2 3\n"), std::runtime_error);
}

}  // namespace
}  // namespace collided::growth
