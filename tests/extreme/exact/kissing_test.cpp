// Two shapes that touch in one point: one rounding nearer overlaps, one farther is apart, and every pair of kinds has
// formulas of its own that round.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::kissing_test {
namespace {

// Each kind reaches to x = 1 when its place is 0, and to x - 1 when turned round.
Sphere sphere_at(double x) { return {{x, 0, 0}, 1}; }
Box box_at(double x) { return {.center = {x, 0, 0}, .half_m = {1, 1, 1}}; }
Capsule capsule_at(double x) { return {{x, -1, 0}, {x, 1, 0}, 1}; }
Triangle pointing(double x, double side) { return {{x, -1, 0}, {x, 1, 0}, {x + side, 0, 0}}; }

template <class A, class B>
void expect_kiss(const A& a, const B& kissing, const B& nearer, const B& farther) {
  for (const int power : {-600, -40, 0, 30, 600}) {
    const extreme::Scaling scale{power};
    EXPECT_TRUE(overlaps(scale(a), scale(kissing)).yes()) << "2^" << power;
    EXPECT_TRUE(overlaps(scale(kissing), scale(a)).yes()) << "2^" << power;
    EXPECT_TRUE(overlaps(scale(a), scale(nearer)).yes()) << "2^" << power;
    EXPECT_EQ(overlaps(scale(a), scale(farther)).decision, Decision::no) << "2^" << power;
    EXPECT_EQ(overlaps(scale(farther), scale(a)).decision, Decision::no) << "2^" << power;
  }
}

template <class A, class Place>
void expect_kiss_at_two(const A& a, const Place& place) {
  expect_kiss(a, place(2.0), place(extreme::down(2)), place(extreme::up(2)));
}

template <class Place>
void expect_all_first_kinds(const Place& place) {
  expect_kiss_at_two(sphere_at(0), place);
  expect_kiss_at_two(box_at(0), place);
  expect_kiss_at_two(capsule_at(0), place);
}

TEST(ExtremeKissing, EveryPairOfSolids) {
  expect_all_first_kinds([](double x) { return sphere_at(x); });
  expect_all_first_kinds([](double x) { return box_at(x); });
  expect_all_first_kinds([](double x) { return capsule_at(x); });
}

TEST(ExtremeKissing, EveryKindAgainstATriangle) {
  const auto place = [](double x) { return pointing(x, -1); };
  expect_all_first_kinds(place);
  expect_kiss_at_two(pointing(0, 1), place);
}

// Beside the common axis by less than any rounding could show in the sum of squares: two balls are apart, flat faces
// still meet.
TEST(ExtremeKissing, BesideTheAxisByTheSmallestDouble) {
  EXPECT_EQ(overlaps(sphere_at(0), Sphere{{2, 0x1p-1074, 0}, 1}).decision, Decision::no);
  EXPECT_EQ(overlaps(sphere_at(0), Sphere{{2, 1e-200, 1e-300}, 1}).decision, Decision::no);
  EXPECT_TRUE(overlaps(box_at(0), Sphere{{2, 0x1p-1074, 0}, 1}).yes());
  EXPECT_TRUE(overlaps(capsule_at(0), Sphere{{2, 0x1p-1074, 0}, 1}).yes());
  EXPECT_EQ(overlaps(capsule_at(0), Sphere{{2, 0, 0x1p-1074}, 1}).decision, Decision::no);
}

TEST(ExtremeKissing, TheDepthOfAKissIsNothing) {
  EXPECT_EQ(contact(sphere_at(0), sphere_at(2)).depth_m, 0);
  EXPECT_EQ(contact(box_at(0), box_at(2)).depth_m, 0);
  EXPECT_EQ(contact(sphere_at(0), box_at(2)).depth_m, 0);
  const Contact rounds = contact(capsule_at(0), capsule_at(2));
  EXPECT_LE(rounds.depth_m, rounds.depth_error_m);
  EXPECT_LE(rounds.depth_error_m, 1e-14);
  EXPECT_EQ(contact(sphere_at(0), pointing(2, -1)).depth_m, 0);
  EXPECT_LE(contact(sphere_at(0), sphere_at(extreme::down(2))).depth_m, 3e-16);
}

}  // namespace
}  // namespace collided::engine::kissing_test
