#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::overlap_oracle_test {
namespace {

using oracle::Family;
using oracle::figure;
using oracle::RandomShapes;

/// Every family, `count` pairs each: the product, both orders, against the twin. Both answers must occur.
template <class MakeA, class MakeB, class Twin>
void compare(int count, std::uint64_t seed, MakeA make_a, MakeB make_b, Twin twin) {
  std::mt19937_64 generator = oracle::seeded(seed);
  int yes = 0;
  int no = 0;
  for (const Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < count; ++i) {
      const auto a = make_a(shapes);
      const auto b = make_b(shapes);
      const bool truth = twin(a, b);
      const Decision expected = truth ? Decision::yes : Decision::no;
      ASSERT_EQ(overlaps(a, b).decision, expected) << name(family) << " pair " << i;
      ASSERT_EQ(overlaps(b, a).decision, expected) << name(family) << " swapped pair " << i;
      ++(truth ? yes : no);
    }
  }
  EXPECT_GT(yes, count / 4);
  EXPECT_GT(no, count / 4);
}

const auto kSphere = [](RandomShapes& s) { return s.sphere(); };
const auto kBox = [](RandomShapes& s) { return s.box(); };
const auto kCapsule = [](RandomShapes& s) { return s.capsule(); };
const auto kTriangle = [](RandomShapes& s) { return s.triangle(); };
const auto kByDistance = [](const auto& a, const auto& b) { return oracle::overlaps(figure(a), figure(b)); };
const auto kByClipping = [](const auto& a, const auto& b) { return oracle::overlaps_by_clipping(a, b); };

TEST(ExactOverlapOracle, SphereSphere) { compare(2000, 1, kSphere, kSphere, kByDistance); }
TEST(ExactOverlapOracle, SphereBox) { compare(40, 2, kSphere, kBox, kByDistance); }
TEST(ExactOverlapOracle, SphereCapsule) { compare(1000, 3, kSphere, kCapsule, kByDistance); }
TEST(ExactOverlapOracle, SphereTriangle) { compare(200, 4, kSphere, kTriangle, kByDistance); }
TEST(ExactOverlapOracle, BoxBox) { compare(15, 5, kBox, kBox, kByClipping); }
TEST(ExactOverlapOracle, BoxCapsule) { compare(15, 6, kBox, kCapsule, kByDistance); }
TEST(ExactOverlapOracle, BoxTriangle) { compare(15, 7, kBox, kTriangle, kByClipping); }
TEST(ExactOverlapOracle, CapsuleCapsule) { compare(300, 8, kCapsule, kCapsule, kByDistance); }
TEST(ExactOverlapOracle, CapsuleTriangle) { compare(100, 9, kCapsule, kTriangle, kByDistance); }
TEST(ExactOverlapOracle, TriangleTriangle) { compare(25, 10, kTriangle, kTriangle, kByClipping); }

}  // namespace
}  // namespace collided::engine::overlap_oracle_test
