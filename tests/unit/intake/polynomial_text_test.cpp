// Polynomials as their authors write them: what is taken, what is refused and what is said then.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "server/exact_phase/ray/implicit_ray.hpp"
#include "server/intake/readers/polynomial_text.hpp"
#include "tests/unit/intake/loading.hpp"

namespace collided::engine {
namespace {

std::string complaint(const std::string& text) {
  try {
    read_implicit_surface(text);
  } catch (const std::invalid_argument& wrong) { return wrong.what(); }
  return "taken";
}

/// Where f is zero along the x axis from -10 on.
double first_zero(const std::string& text) {
  ImplicitHit hit;
  EXPECT_TRUE(cast_ray({{-10, 0, 0}, {1, 0, 0}}, read_implicit_surface(text), hit).yes()) << text;
  return hit.point.x();
}

TEST(IntakePolynomialText, OperatorsBindAsInMathematics) {
  EXPECT_NEAR(first_zero("-x^2+4"), -2, 1e-14);
  EXPECT_NEAR(first_zero("2*x^2-8"), -2, 1e-14);
  EXPECT_NEAR(first_zero("1-x-2-3"), -4, 1e-14);
  EXPECT_NEAR(first_zero("(x+1)*(x+2)^2*(x+3)"), -3, 1e-14);
  EXPECT_NEAR(first_zero("+x*-1*-1 - -5"), -5, 1e-14);
  EXPECT_NEAR(first_zero(" 1.5e1*x\t+ .5*30\\\n + 0*(y+z) "), -1, 1e-14);
  EXPECT_NEAR(first_zero("x+7 in -8,-1,-1, 8,1,1"), -7, 1e-14);
}

TEST(IntakePolynomialText, WhatIsWrongIsSaidWithItsColumn) {
  EXPECT_EQ(complaint("x/2"),
            "column 2: '/': a quotient is no polynomial; of a number, write 0.5*x; expected + - * ^, 'in' and a box, "
            "or the end");
  EXPECT_EQ(
      complaint("2x"),
      "column 2: 'x' without an operator before it: products are written with *; expected + - * ^, 'in' and a box, or "
      "the end");
  EXPECT_EQ(complaint("x+w"), "column 3: 'w'; a number, x, y, z or '(' is needed");
  EXPECT_EQ(complaint("(x+y"), "column 5: the end; expected + - * ^ or ')'");
  EXPECT_EQ(complaint("3*2"), "column 4: there is no x, y or z in it: a constant has no surface");
  EXPECT_EQ(complaint("x^-1"), "column 3: '-' after ^; a whole number from 0 to 8 is needed");
  EXPECT_EQ(complaint("1e-999*x"), "column 1: number '1e-999' is beyond the doubles (4.9e-324 to 1.8e308)");
  EXPECT_EQ(complaint("x in 0 0 0 1 -1 1"), "column 18: the box is empty: along y from 0 to -1");
  EXPECT_EQ(complaint("x in 0 0 0 1 1"),
            "column 15: the end; a box takes six finite numbers, its lowest and its highest corner");
  EXPECT_EQ(complaint(""), "column 1: the end; a number, x, y, z or '(' is needed");
}

// Each limit at itself is taken, one more is not.
TEST(IntakePolynomialText, LimitsAreWhereTheyAreStated) {
  EXPECT_EQ(complaint("x^8"), "taken");
  EXPECT_EQ(complaint("x^9"), "column 3: exponent '9', allowed are 0 to 8");
  EXPECT_EQ(complaint("x^4*(y*z)^2"), "taken");
  EXPECT_EQ(complaint("x^5*(y*z)^2"), "column 12: degree 9 as written, at most 8 is taken");
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '(') + "x" + std::string(static_cast<std::size_t>(depth), ')');
  };
  EXPECT_EQ(complaint(nested(64)), "taken");
  EXPECT_NE(complaint(nested(65)).find("more than 64 parentheses"), std::string::npos);
  // One value waits at each level, and the last level holds two.
  const auto waiting = [](int values) {
    std::string text = "x";
    for (int i = 1; i < values; ++i) text = "y+(" + text + ")";
    return text;
  };
  EXPECT_EQ(complaint(waiting(16)), "taken");
  EXPECT_NE(complaint(waiting(17)).find("more than 16 values wait"), std::string::npos);
  std::string sum = "x";
  for (int steps = 1; steps + 2 <= ImplicitSurface::kMostSteps; steps += 2) sum += "+y";
  EXPECT_EQ(complaint(sum), "taken");
  EXPECT_NE(complaint(sum + "+y").find("more than 1000 numbers, variables and operators"), std::string::npos);
  EXPECT_NE(complaint(std::string(kMaxPolynomialBytes, ' ') + "x").find("bytes of polynomial, at most 65536 are read"),
            std::string::npos);
}

TEST(IntakePolynomialText, AScenesImplicitLinesAreCheckedAndLeftOut) {
  const test::Loaded loaded = test::load(
      "a.surfaces", "globe sphere 1 count 16 9\nring implicit x^2+y^2 \\\n - 1 in 0 0 0 1 1 1 # a quarter\n");
  EXPECT_EQ(loaded.scene.parts.size(), 1u);
  ASSERT_EQ(loaded.report.refused.size(), 1u);
  EXPECT_EQ(loaded.report.refused[0],
            "'ring': an implicit surface is not cut into triangles and left out here; 'collide implicit' asks it");
  EXPECT_EQ(
      test::complaint("a.surfaces", "ring implicit x^\n"),
      "a.surfaces: line 1: polynomial, column 3: the end after ^; a whole number from 0 to 8 is needed. Nothing was "
      "loaded.");
}

}  // namespace
}  // namespace collided::engine
