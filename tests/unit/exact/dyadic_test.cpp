#include "server/exact_phase/arithmetic/dyadic.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

/// What a number is, and how it is written: the error of what is rounded to a double depends on that.
void expect_same(const Dyadic& a, const Dyadic& b) {
  EXPECT_EQ(a.finite(), b.finite());
  EXPECT_EQ(a.mantissa(), b.mantissa());
  EXPECT_EQ(a.exponent(), b.exponent());
}

mpq_class rational(const Dyadic& x) {
  mpq_class value(x.mantissa());
  if (x.exponent() >= 0) mpq_mul_2exp(value.get_mpq_t(), value.get_mpq_t(), static_cast<mp_bitcnt_t>(x.exponent()));
  else mpq_div_2exp(value.get_mpq_t(), value.get_mpq_t(), static_cast<mp_bitcnt_t>(-x.exponent()));
  return value;
}

/// Of all sizes, with many and few digits, zeros of both signs and denormals among them.
std::vector<double> hard_doubles(std::mt19937_64& random, int count) {
  std::vector<double> list{0.0,
                           -0.0,
                           1,
                           -1,
                           0.5,
                           3,
                           std::numeric_limits<double>::max(),
                           -std::numeric_limits<double>::max(),
                           std::numeric_limits<double>::min(),
                           std::numeric_limits<double>::denorm_min(),
                           -std::numeric_limits<double>::denorm_min()};
  while (static_cast<int>(list.size()) < count) {
    const double any = std::bit_cast<double>(random());
    if (!std::isfinite(any)) continue;
    list.push_back(any);
    list.push_back(std::ldexp(static_cast<double>(static_cast<std::int64_t>(random() % 2'001) - 1'000),
                              static_cast<int>(random() % 21) - 10));
    list.push_back(any * std::numeric_limits<double>::min());
  }
  return list;
}

TEST(Dyadic, ADoubleIsItselfWithAnOddMantissa) {
  std::mt19937_64 random = oracle::seeded(20261202);
  for (const double x : hard_doubles(random, 20'000)) {
    const Dyadic exact(x);
    ASSERT_EQ(rational(exact), mpq_class(x)) << std::hexfloat << x;
    ASSERT_TRUE(exact.finite());
    ASSERT_TRUE(x == 0 || mpz_odd_p(exact.mantissa().get_mpz_t())) << std::hexfloat << x;
    ASSERT_TRUE(x != 0 || exact.exponent() == 0);
  }
  EXPECT_FALSE(Dyadic(std::numeric_limits<double>::infinity()).finite());
  EXPECT_FALSE(Dyadic(std::nan("")).finite());
  EXPECT_EQ(Dyadic(std::numeric_limits<double>::infinity()).sign(), 0);
}

// Sums, differences and products as by rationals; those that reuse a temporary's memory are the same and written the same.
TEST(Dyadic, OperationsAreExactAndTemporariesChangeNothing) {
  std::mt19937_64 random = oracle::seeded(20261203);
  const std::vector<double> list = hard_doubles(random, 3'000);
  const auto any = [&] { return list[random() % list.size()]; };
  for (int i = 0; i < 20'000; ++i) {
    const double x = any(), y = any(), z = any();
    const Dyadic a = Dyadic(x) * Dyadic(z), b(y);
    ASSERT_EQ(rational(a + b), mpq_class(x) * mpq_class(z) + mpq_class(y));
    ASSERT_EQ(rational(b - a), mpq_class(y) - mpq_class(x) * mpq_class(z));
    expect_same(Dyadic(x) * Dyadic(z) + b, a + b);
    expect_same(Dyadic(x) * Dyadic(z) - b, a - b);
    expect_same(Dyadic(y) + a, b + a);
    expect_same(Dyadic(y) - a, b - a);
    expect_same(times(a, y), b * a);
    if (HasFailure()) FAIL() << std::hexfloat << x << ' ' << y << ' ' << z;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE((Dyadic(infinity) + Dyadic(1)).finite());
  EXPECT_FALSE((Dyadic(1) - Dyadic(infinity)).finite());
  EXPECT_FALSE(times(Dyadic(1), infinity).finite());
}

}  // namespace
}  // namespace collided::engine
