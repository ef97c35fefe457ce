#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/moeller.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::Moeller;
using oracle::Rational;

/// The published code's.
constexpr double kEpsilon = 1e-6;

constexpr std::array<std::array<int, 3>, 6> kOrders{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

Triangle ordered(const Triangle& t, const std::array<int, 3>& order) {
  const Vec3 corner[3] = {t.a, t.b, t.c};
  return {corner[order[0]], corner[order[1]], corner[order[2]]};
}

/// How many of the 72 ways to write a pair down (six orders of each, and either first) answer yes.
template <class Test>
int yes_of_72(const Triangle& a, const Triangle& b, const Test& test) {
  int yes = 0;
  for (const auto& of_a : kOrders) {
    for (const auto& of_b : kOrders) {
      const Triangle p = ordered(a, of_a);
      const Triangle q = ordered(b, of_b);
      yes += (test(p, q) ? 1 : 0) + (test(q, p) ? 1 : 0);
    }
  }
  return yes;
}

template <class Number>
auto moeller(Number epsilon) {
  return [test = Moeller<Number>(std::move(epsilon))](const Triangle& a, const Triangle& b) {
    return test(Moeller<Number>::corners(a), Moeller<Number>::corners(b));
  };
}

bool has_area(const Triangle& t) {
  const oracle::Point a = oracle::exact(t.a), b = oracle::exact(t.b), c = oracle::exact(t.c);
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if ((b[u] - a[u]) * (c[v] - a[v]) != (b[v] - a[v]) * (c[u] - a[u])) return true;
  }
  return false;
}

struct Rates {
  int pairs = 0;
  int touching = 0;
  int plain_wrong = 0, plain_varies = 0;
  int epsilon_wrong = 0, epsilon_varies = 0;
  int exact_wrong = 0, exact_varies = 0;
  int ours_varies = 0;
};

/// Of triangles in general position, sharing what neighbours in a mesh share, parallel, or in one plane.
Rates rates(oracle::Family family, int pairs, std::mt19937_64& random) {
  oracle::RandomShapes shapes(random, family);
  const auto plain = moeller<double>(0);
  const auto epsilon = moeller<double>(kEpsilon);
  const auto exact = moeller<Rational>(0);
  const auto ours = [](const Triangle& a, const Triangle& b) { return overlaps(a, b).yes(); };
  Rates r;
  while (r.pairs < pairs) {
    const Triangle a = shapes.triangle();
    Triangle b = shapes.triangle();
    if (r.pairs % 4 == 1) b.a = a.b;                                         // a common vertex
    if (r.pairs % 4 == 2) b.a = 0.5 * (a.a + a.b);                           // a vertex at an edge
    if (r.pairs % 8 == 3) b.b = a.a + (b.a - a.c), b.c = a.b + (b.a - a.c);  // parallel, as mesh and its copy
    if (r.pairs % 8 == 7) {  // shifted in its own plane, but for rounding
      const Vec3 shift = 0.25 * (a.b - a.a) + 0.5 * (a.c - a.a);
      b = {a.a + shift, a.b + shift, a.c + shift};
    }
    if (!has_area(a) || !has_area(b)) continue;
    ++r.pairs;
    const bool truth = ours(a, b);
    r.touching += truth ? 1 : 0;
    const int of_ours = yes_of_72(a, b, ours), of_plain = yes_of_72(a, b, plain), of_epsilon = yes_of_72(a, b, epsilon);
    r.ours_varies += of_ours % 72 != 0;
    r.plain_varies += of_plain % 72 != 0;
    r.epsilon_varies += of_epsilon % 72 != 0;
    r.plain_wrong += plain(a, b) != truth;
    r.epsilon_wrong += epsilon(a, b) != truth;
    // Of one in nine, which are of every kind: 72 times in rationals take milliseconds.
    const bool all_orders = r.pairs % 9 == 0;
    const int of_exact = all_orders ? yes_of_72(a, b, exact) : 72 * exact(a, b);
    r.exact_varies += of_exact % 72 != 0;
    r.exact_wrong += (of_exact == 72) != truth;
  }
  return r;
}

// B19. The exact predicates and Moeller's test in rationals agree on every pair, in all 72 orders; in doubles, with or
// without the published epsilon, the test is wrong and depends on the order. How often, is printed.
TEST(MoellerTest, OnlyItsExactFormAgreesWithTheExactPredicates) {
  std::mt19937_64 random = oracle::seeded(1997);
  std::printf("%-12s %6s %9s  %14s  %14s  %14s   (wrong / depends on the order)\n", "family", "pairs", "touching",
              "plain", "epsilon 1e-6", "exact");
  Rates all;
  for (const oracle::Family family : oracle::kFamilies) {
    // Products of three lengths of 1e-170 are 0 in double: there the plain form calls everything coplanar.
    const Rates r = rates(family, 400, random);
    std::printf("%-12s %6d %9d  %6d / %5d  %6d / %5d  %6d / %5d\n", oracle::name(family), r.pairs, r.touching,
                r.plain_wrong, r.plain_varies, r.epsilon_wrong, r.epsilon_varies, r.exact_wrong, r.exact_varies);
    EXPECT_EQ(r.exact_wrong, 0) << oracle::name(family);
    EXPECT_EQ(r.exact_varies, 0) << oracle::name(family);
    EXPECT_EQ(r.ours_varies, 0) << oracle::name(family);
    EXPECT_GT(r.touching, 0) << oracle::name(family);
    EXPECT_LT(r.touching, r.pairs) << oracle::name(family);
    all.plain_wrong += r.plain_wrong;
    all.plain_varies += r.plain_varies;
    all.epsilon_wrong += r.epsilon_wrong;
    all.epsilon_varies += r.epsilon_varies;
  }
  EXPECT_GT(all.plain_wrong, 0);
  EXPECT_GT(all.plain_varies, 0);
  EXPECT_GT(all.epsilon_wrong, 0);
  EXPECT_GT(all.epsilon_varies, 0);
}

// By hand: the paper's figure 2 (crossing, planes cut but intervals apart), one plane, one inside the other.
TEST(MoellerTest, DecidesThePapersCases) {
  const Triangle flat{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto plain = moeller<double>(0);
  EXPECT_TRUE(plain(flat, {{1, 1, -1}, {1, 1, 1}, {2, 2, 1}}));
  EXPECT_FALSE(plain(flat, {{5, 5, -1}, {5, 5, 1}, {6, 6, 1}}));
  EXPECT_FALSE(plain(flat, {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}));
  EXPECT_TRUE(plain(flat, {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}));
  EXPECT_TRUE(plain({{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, flat));
  EXPECT_FALSE(plain(flat, {{3, 3, 0}, {5, 3, 0}, {3, 5, 0}}));
  EXPECT_TRUE(plain(flat, {{4, 0, 0}, {5, 0, 1}, {5, 1, 1}}));
  EXPECT_TRUE(plain(flat, {{1, 1, 0}, {5, 0, 1}, {5, 1, 1}}));
}

}  // namespace
}  // namespace collided::engine
