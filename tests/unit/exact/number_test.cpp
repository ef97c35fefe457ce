#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/arithmetic/scaled.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/bounded.hpp"
#include "server/geometry/expansion.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::number_test {
namespace {

using oracle::Rational;

/// The same running error analysis without rounding.
struct Analysed {
  Rational exact;
  Rational error;
};

template <class Number>
void follow_chain(std::uint64_t seed, bool worst_case) {
  std::mt19937_64 generator = oracle::seeded(seed);
  std::uniform_real_distribution<double> any(-2, 2);
  for (int chain = 0; chain < 200; ++chain) {
    Number x(any(generator));
    Analysed truth{Rational(x.value), 0};
    for (int step = 0; step < 12; ++step) {
      const double operand = any(generator);
      const Number before = x;
      const bool product = step % 2 == 0;
      x = product ? x * Number(operand) : x + Number(operand);
      truth.exact = product ? Rational(truth.exact * Rational(operand)) : Rational(truth.exact + Rational(operand));
      if (product) truth.error *= abs(Rational(operand));
      truth.error += abs(Rational(x.value)) * Rational(kRoundoff);
      ASSERT_LE(abs(Rational(x.value) - truth.exact), Rational(x.bound())) << before.value << " " << operand;
      // The bound itself is a sum of rounded doubles, and may not come out below the exact one.
      ASSERT_TRUE(!worst_case || truth.error <= Rational(x.bound())) << "step " << step;
    }
  }
}

TEST(ExactBounded, TheBoundHoldsForLongChains) { follow_chain<Bounded>(71, true); }
TEST(ExactTraced, TheBoundHoldsForLongChains) { follow_chain<Traced>(72, false); }

TEST(ExactBounded, UnderflowIsNeverSure) {
  const Bounded tiny(1e-200);
  EXPECT_FALSE((tiny * tiny).exactly_zero());
  EXPECT_GT((tiny * tiny).bound(), 0);
  EXPECT_TRUE((tiny * Bounded(0)).exactly_zero());
}

TEST(ExactBounded, OverflowIsNeverSure) {
  const Bounded huge(1e200);
  const Bounded square = huge * huge;
  EXPECT_FALSE(square.value > square.bound());
  const Bounded difference = square - square;
  EXPECT_FALSE(std::abs(difference.value) <= difference.bound() && std::isfinite(difference.bound()));
}

TEST(ExactBounded, QuotientAndRootContainTheTruth) {
  std::mt19937_64 generator = oracle::seeded(73);
  std::uniform_real_distribution<double> any(0.1, 2);
  for (int i = 0; i < 500; ++i) {
    const double a = any(generator);
    const double b = any(generator);
    const Bounded quotient = Bounded(a) / Bounded(b);
    EXPECT_LE(abs(Rational(quotient.value) - Rational(a) / Rational(b)), Rational(quotient.bound()));
    const Bounded root = sqrt(Bounded(a));
    const Rational low = Rational(root.value) - Rational(root.bound());
    const Rational high = Rational(root.value) + Rational(root.bound());
    EXPECT_LE(low * low, Rational(a));
    EXPECT_GE(high * high, Rational(a));
  }
  EXPECT_TRUE(std::isinf((Bounded(1) / Bounded(1e-4, 1e-3)).bound()));
}

TEST(ExactTraced, SmallIntegersStayExact) {
  const Traced x = Traced(3) * Traced(-7) + Traced(21.5) - Traced(0.5);
  EXPECT_TRUE(x.exactly_zero());
  EXPECT_GT((Traced(0.1) * Traced(0.1)).error, 0);
}

TEST(ExactExpansion, SumsAndProductsAreExact) {
  std::mt19937_64 generator = oracle::seeded(74);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto wild = [&] { return std::ldexp(any(generator), std::uniform_int_distribution<int>(-60, 60)(generator)); };
  for (int i = 0; i < 500; ++i) {
    const double a = wild();
    const double b = wild();
    const double c = wild();
    const double d = wild();
    const Expansion sum = (Expansion(a) - Expansion(b)) * (Expansion(c) + Expansion(d)) - Expansion(a) * Expansion(c);
    const Rational truth = (Rational(a) - Rational(b)) * (Rational(c) + Rational(d)) - Rational(a) * Rational(c);
    ASSERT_FALSE(sum.lost());
    EXPECT_EQ(sum.leading() > 0, truth > 0);
    EXPECT_EQ(sum.leading() == 0, truth == 0);
    EXPECT_LE(abs(Rational(sum.rounded()) - truth), abs(truth) * Rational(0x1p-51));
  }
  const Expansion x = Expansion(0.1) + Expansion(1e30) - Expansion(1e30) - Expansion(0.1);
  EXPECT_EQ(x.leading(), 0);
}

/// value * 2^power
Rational shifted_exactly(double value, long power) {
  const Rational factor(boost::multiprecision::cpp_int(1) << static_cast<unsigned long>(std::abs(power)));
  return power < 0 ? Rational(Rational(value) / factor) : Rational(Rational(value) * factor);
}

/// From the smallest double to the largest.
double of_any_size(std::mt19937_64& generator) {
  const double mantissa = std::uniform_real_distribution<double>(-2, 2)(generator);
  return std::ldexp(mantissa, std::uniform_int_distribution<int>(-1'074, 1'022)(generator));
}

// Beyond both ends of double: the truth is within the bound, and products stay sharp.
TEST(ExactScaled, TheBoundHoldsAtAnySize) {
  using kernel::Scaled;
  std::mt19937_64 generator = oracle::seeded(75);
  int beyond = 0;
  for (int chain = 0; chain < 300; ++chain) {
    Scaled x(of_any_size(generator));
    Rational exact = shifted_exactly(x.value.value, x.power);
    const bool products_alone = chain % 3 == 0;
    for (int step = 0; step < 8; ++step) {
      const double operand = of_any_size(generator);
      switch (products_alone ? 0 : step % 4) {
        case 0:
          x = x * Scaled(operand);
          exact *= Rational(operand);
          break;
        case 1:
          x = x + Scaled(operand);
          exact += Rational(operand);
          break;
        case 2:
          x = Scaled(operand) - x;
          exact = Rational(operand) - exact;
          break;
        default: x = x * x; exact *= exact;
      }
      ASSERT_LE(abs(shifted_exactly(x.value.value, x.power) - exact), shifted_exactly(x.value.bound(), x.power))
          << "chain " << chain << ", step " << step;
      ASSERT_TRUE(!products_alone || x.value.bound() <= 1e-14 * std::abs(x.value.value));
      beyond += x.power > 1'000 || x.power < -1'100 ? 1 : 0;
    }
  }
  EXPECT_GT(beyond, 500);
}

TEST(ExactScaled, DoublesAreExactAndEqualOnesDifferByZero) {
  using kernel::Scaled;
  std::mt19937_64 generator = oracle::seeded(76);
  for (int i = 0; i < 2'000; ++i) {
    const double number = of_any_size(generator);
    const Scaled x(number);
    ASSERT_EQ(shifted_exactly(x.value.value, x.power), Rational(number));
    ASSERT_EQ(x.value.error, 0);
    ASSERT_TRUE((x - Scaled(number)).value.exactly_zero());
  }
}

// What leaves the range of double is not close as a rule, and then needs no rational.
TEST(ExactScaled, DecidesWhatIsFarOutOfRange) {
  const Triangle triangle{{0.1, 0.2, 0.3}, {1.3, 0.2, 0.1}, {0.2, 1.4, 0.7}};
  const std::uint64_t before = kernel::rungs.rational;
  EXPECT_EQ(overlaps(Sphere{{-1.9, 2.7, -3.3}, 1e300}, triangle).decision, Decision::yes);
  EXPECT_EQ(overlaps(Sphere{{1e252, 0.5, -2}, 1e300}, triangle).decision, Decision::yes);
  EXPECT_EQ(overlaps(Sphere{{1.5e300, 0.5, -2}, 1e300}, triangle).decision, Decision::no);
  EXPECT_EQ(overlaps(Sphere{{0.1, 0.2, 0.3}, 1e-300}, triangle).decision, Decision::yes);
  EXPECT_EQ(kernel::rungs.rational, before);
  // As close as that only rationals know.
  EXPECT_EQ(overlaps(Sphere{{1e300, 0.5, 0.25}, 1e300}, triangle).decision, Decision::yes);
  EXPECT_GT(kernel::rungs.rational, before);
}

// Half and 2^-1074 make a half; what was lost is an error, and a quarter of it is still one.
TEST(ExactTraced, AnErrorThatUnderflowsIsStillAnError) {
  const Traced sum = Traced(0.5) + Traced(0x1p-1074);
  EXPECT_EQ(sum.error, 0x1p-1074);
  const Traced part = Traced(0.25) * sum;
  EXPECT_GT(part.bound(), 0);
  EXPECT_FALSE((part - Traced(0.125)).exactly_zero());
}

TEST(ExactExpansion, OutOfRangeIsLost) {
  EXPECT_TRUE((Expansion(1e-200) * Expansion(1e-200)).lost());
  EXPECT_TRUE((Expansion(1e200) * Expansion(1e200)).lost());
  EXPECT_TRUE(Expansion(std::numeric_limits<double>::quiet_NaN()).lost());
  EXPECT_TRUE((Expansion(std::numeric_limits<double>::infinity()) * Expansion(0)).lost());
}

}  // namespace
}  // namespace collided::engine::number_test
